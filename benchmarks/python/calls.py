# SPDX-License-Identifier: BSD-2-Clause
"""calls.py MODEL...: what calls from Python cost. Variants run in turn; each figure is the median of 41 rounds, with its quartiles."""
import json
import pathlib
import statistics
import subprocess
import sys
import timeit

import numpy as np

import libdyn as dyn

ROUNDS = 41
CALLS = 2000


def measure(variants):
    """Returns the sorted times of a call [ns] of each variant."""
    times = {name: [] for name in variants}
    for _ in range(ROUNDS):
        for name, call in variants.items():
            times[name].append(timeit.timeit(call, number=CALLS) / CALLS * 1e9)
    return {name: sorted(x) for name, x in times.items()}


def from_cpp(path):
    """Returns the time of rnea from C++ [ns], by `dyn bench`."""
    command = [pathlib.Path(dyn.__file__).parents[2] / "bin" / "dyn", "bench", path, "--only", "rnea", "--json"]
    answer = subprocess.run(command, capture_output=True, text=True)
    if answer.returncode != 0:
        return None
    entries = map(json.loads, answer.stdout.splitlines())
    return next((x["ns"] for x in entries if (x["scalar"], x["mode"]) == ("double", "single")), None)


for path in sys.argv[1:]:
    model = dyn.compile(dyn.load(path))
    data = dyn.Data(model)
    q = dyn.random_configuration(model, 1)
    v, a = np.random.default_rng(1).normal(size=(2, model.nv))
    tau, mass = np.empty(model.nv), np.empty((model.nv, model.nv))
    derivatives = tuple(np.empty((model.nv, model.nv)) for _ in range(3))
    variants = {
        "rnea, out=": lambda: dyn.rnea(model, data, q, v, a, out=tau),
        "rnea, new array": lambda: dyn.rnea(model, data, q, v, a),
        "crba, out=": lambda: dyn.crba(model, data, q, out=mass),
        "aba, out=": lambda: dyn.aba(model, data, q, v, a, out=tau),
        "compute_rnea_derivatives, out=": lambda: dyn.compute_rnea_derivatives(model, data, q, v, a, out=derivatives),
        "numpy: v + a": lambda: v + a,
        "an empty function": lambda: None,
    }
    try:
        import pinocchio

        peer = pinocchio.buildModelFromUrdf(str(path))
        peer_data = peer.createData()
        peer_q = pinocchio.neutral(peer)
        variants["Pinocchio: rnea"] = lambda: pinocchio.rnea(peer, peer_data, peer_q, v, a)
    except ImportError:
        pass
    print(f"{model.name}, {model.nv} degrees of freedom: ns per call, median (quartiles)")
    for name, times in measure(variants).items():
        print(f"  {name:32} {statistics.median(times):8.0f} ({times[len(times) // 4]:.0f} .. {times[3 * len(times) // 4]:.0f})")
    cpp = from_cpp(path)
    if cpp:
        print(f"  {'C++: rnea (dyn bench)':32} {cpp:8.0f}")
