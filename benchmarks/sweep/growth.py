#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""growth.py DYN MODEL: how the cost of a sweep grows with the number of ranks.

Measures rank 0 and the file system on this machine, with 2 to 16 ranks and chunks that cost next to nothing, so that only the overhead is
left. Then simulates sweeps of up to 10^4 ranks: each rank asks rank 0 for a chunk, computes it, writes its file, and asks again. Rank 0 answers
one rank after the other; the file system makes one file after the other. The efficiency is the time that all ranks compute over the time that
they are there."""

import heapq
import json
import os
import random
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

RANKS = (2, 4, 8, 16)
SAMPLES, CHUNK = 8000, 4  # measured: 2000 chunks


def seconds_in(line):
    number, unit = re.search(r" in ([\d.e+-]+) (s|ms)$", line).groups()
    return float(number) * {"s": 1, "ms": 1e-3}[unit]


def measure(dyn, model, ranks, folder):
    """Returns seconds: of rank 0 for one request, of all processors for one chunk, of merging one chunk."""
    study = os.path.join(folder, "study.json")
    with open(study, "w") as file:
        json.dump({"model": os.path.abspath(model), "task": "compute", "functions": ["com"], "samples": SAMPLES, "chunk": CHUNK,
                   "vary": {"q": {"uniform": "limits"}}}, file)
    used = []
    for samples in (ranks * CHUNK, SAMPLES):  # the first is what starting takes
        with open(study) as file:
            smaller = {**json.load(file), "samples": samples}
        with open(study, "w") as file:
            json.dump(smaller, file)
        before, out = resource.getrusage(resource.RUSAGE_CHILDREN), os.path.join(folder, f"out{ranks}_{samples}")
        command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), dyn, "sweep", study, "--out", out, "--verbose"]
        lines = subprocess.run(command, check=True, capture_output=True, text=True).stderr.splitlines()
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    answered = next(line for line in lines if "requests of other ranks" in line)
    requests = int(re.search(r"answered (\d+)", answered)[1])
    chunks = SAMPLES // CHUNK - ranks
    merged = next(line for line in lines if "merged" in line)
    return seconds_in(answered) / requests, (used[1] - used[0]) / chunks, seconds_in(merged) / (SAMPLES // CHUNK)


def simulate(ranks, chunk, service, files, rounds=20, spread=0.3):
    """Returns the efficiency, and the busy shares of rank 0 and of the file system. Chunks take `chunk` seconds on average, log-normally spread."""
    rng = random.Random(ranks)
    mean = -spread * spread / 2  # so that the average is `chunk`
    left, answers_at, files_at, computed, end = rounds * ranks, 0.0, 0.0, 0.0, 0.0
    events = [(0.0, k, "ask") for k in range(ranks)]
    while events:
        now, rank, what = heapq.heappop(events)
        if what == "ask":
            answers_at = max(answers_at, now) + service
            if left == 0:
                end = max(end, answers_at)
                continue
            left -= 1
            duration = chunk * rng.lognormvariate(mean, spread)
            computed += duration
            heapq.heappush(events, (answers_at + duration, rank, "write"))
        else:
            files_at = max(files_at, now) + 1 / files
            heapq.heappush(events, (files_at, rank, "ask"))
    asked = (rounds + 1) * ranks
    return computed / (ranks * end), asked * service / end, rounds * ranks / files / end


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    dyn, model = sys.argv[1:]
    print(f"measured, {SAMPLES // CHUNK} chunks, medians of 3 [us]\n{'ranks':>6} {'answer':>10} {'chunk':>10} {'merge':>10}")
    answers = []
    with tempfile.TemporaryDirectory() as folder:
        for ranks in RANKS:
            runs = []
            for turn in range(3):
                inner = os.path.join(folder, f"{ranks}_{turn}")
                os.mkdir(inner)
                runs.append(measure(dyn, model, ranks, inner))
            answer, chunk, merge = (1e6 * statistics.median(column) for column in zip(*runs))
            answers.append(answer)
            print(f"{ranks:6d} {answer:10.1f} {chunk:10.1f} {merge:10.1f}", flush=True)
    service = 1e-6 * max(answers)
    print(f"\nsimulated, {1e6 * service:.1f} us an answer; efficiency (share of rank 0, share of the file system)")
    header = [f"{chunk:g} s, {files} files/s" for files in (1000, 10000) for chunk in (0.1, 0.5, 5)]
    print(f"{'ranks':>6} " + " ".join(f"{text:>22}" for text in header))
    start = time.monotonic()
    for ranks in (16, 100, 1000, 10000):
        cells = []
        for files in (1000, 10000):
            for chunk in (0.1, 0.5, 5):
                efficiency, answering, writing = simulate(ranks, chunk, service, files)
                cells.append(f"{efficiency:9.3f} ({answering:4.2f}, {writing:4.2f})")
        print(f"{ranks:6d} " + " ".join(f"{cell:>22}" for cell in cells), flush=True)
    print(f"simulated in {time.monotonic() - start:.0f} s")


if __name__ == "__main__":
    main()
