#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""efficiency.py DYN MODEL [SECONDS [ROUNDS]]: what two ranks gain over one.

Runs the same sweep of simulations with one rank and with two, in turn, each about SECONDS (20) with one rank, ROUNDS (5) times. Prints the time that
has passed and the processor time of both, their medians, and the ratios. Nothing else should run on the machine: the ratio of the times that have
passed is at most the number of processors that are free. The processor time of two ranks over that of one tells what the second rank costs."""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time


def study(model, samples):
    return {"model": os.path.abspath(model), "task": "simulate", "time": 0.1, "dt": 0.001, "integrator": "rk4", "samples": samples, "seed": 7,
            "vary": {"q": {"uniform": "limits"}, "v": {"uniform": [-1, 1]}}, "keep": ["final"]}


def run(dyn, path, out, ranks):
    """Returns the seconds that pass, and the processor time of all ranks."""
    command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks), dyn, "sweep", path, "--out", out, "--quiet"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - start, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    if len(sys.argv) not in (3, 4, 5):
        sys.exit(__doc__)
    dyn, model = sys.argv[1:3]
    seconds = float(sys.argv[3]) if len(sys.argv) > 3 else 20
    rounds = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "study.json")

        def write(samples):
            with open(path, "w") as file:
                json.dump(study(model, samples), file)

        times = []
        for samples in (200, 1200):  # the difference is without the start
            write(samples)
            times.append(run(dyn, path, os.path.join(folder, f"trial{samples}"), 1)[1])
        write(max(int(seconds * 1000 / max(times[1] - times[0], 1e-3)), 100))
        passed, used = {1: [], 2: []}, {1: [], 2: []}
        print(f"{'':>8} {'1 rank':>18} {'2 ranks':>18}\n{'':>8} {'passed':>9}{'used':>9} {'passed':>9}{'used':>9} [s]")
        for turn in range(rounds):
            for ranks in (1, 2):
                wall, processor = run(dyn, path, os.path.join(folder, f"out{ranks}_{turn}"), ranks)
                passed[ranks].append(wall)
                used[ranks].append(processor)
            print(f"{turn:8d} {passed[1][-1]:9.2f}{used[1][-1]:9.2f} {passed[2][-1]:9.2f}{used[2][-1]:9.2f}", flush=True)
        middle = {ranks: (statistics.median(passed[ranks]), statistics.median(used[ranks])) for ranks in (1, 2)}
        print(f"{'median':>8} {middle[1][0]:9.2f}{middle[1][1]:9.2f} {middle[2][0]:9.2f}{middle[2][1]:9.2f}")
        faster, dearer = middle[1][0] / middle[2][0], middle[2][1] / middle[1][1]
        print(f"two ranks are {faster:.2f} times as fast as one and use {dearer:.3f} times its processor time")


if __name__ == "__main__":
    main()
