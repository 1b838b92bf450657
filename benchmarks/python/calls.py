# SPDX-License-Identifier: BSD-2-Clause
"""calls.py MODEL...: what calls from Python cost. Variants run in turn; each figure is the median of 41 rounds, with its quartiles.

Peers take part if their modules are installed: Pinocchio, DART (Debian's python3-dartpy) and MuJoCo.
"""
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


def with_pinocchio(path, v, a):
    import pinocchio

    model = pinocchio.buildModelFromUrdf(path)
    data, q = model.createData(), pinocchio.neutral(model)
    return lambda: pinocchio.rnea(model, data, q, v, a)


def with_dart(path, v, a):
    import dartpy

    loader, joints = dartpy.utils.DartLoader(), dartpy.utils.DartLoaderRootJointType
    loader.setOptions(dartpy.utils.DartLoaderOptions(defaultRootJointType=joints.FIXED))
    skeleton = loader.parseSkeleton(path)
    if skeleton is None or skeleton.getNumDofs() != len(v):  # DART ends the process at vectors of another size
        raise ValueError("DART reads another model")
    skeleton.setVelocities(v)
    skeleton.setAccelerations(a)

    def call():
        skeleton.setVelocities(v)
        skeleton.computeInverseDynamics()
        return skeleton.getForces()

    return call


def with_mujoco(path, v, a):
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    tau = np.empty(model.nv)

    def call():
        data.qvel[:] = v
        mujoco.mj_inverse(model, data)
        tau[:] = data.qfrc_inverse

    data.qacc[:] = a
    return call


def peers(path, v, a):
    """Returns calls of inverse dynamics of the peers that are installed and read this file."""
    calls = {}
    for name, make in (("Pinocchio: rnea", with_pinocchio), ("DART: computeInverseDynamics", with_dart), ("MuJoCo: mj_inverse", with_mujoco)):
        try:
            calls[name] = make(path, v, a)
            calls[name]()
        except (ImportError, ValueError, RuntimeError, AttributeError) as problem:
            calls.pop(name, None)
            if not isinstance(problem, ImportError):
                print(f"{name} is left out: {problem}", file=sys.stderr)
    return calls


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
    variants.update(peers(str(pathlib.Path(path).resolve()), v, a))
    print(f"{model.name}, {model.nv} degrees of freedom: ns per call, median (quartiles)")
    for name, times in measure(variants).items():
        print(f"  {name:32} {statistics.median(times):8.0f} ({times[len(times) // 4]:.0f} .. {times[3 * len(times) // 4]:.0f})")
    cpp = from_cpp(path)
    if cpp:
        print(f"  {'C++: rnea (dyn bench)':32} {cpp:8.0f}")
