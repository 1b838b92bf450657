# SPDX-License-Identifier: BSD-2-Clause
"""Sweeps whose task is a function of a Python file: numbers, failures, restarts, and the end of the processes."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

import libdyn as dyn
from libdyn import sweeps
from sweeping import ARM, SweepTest

SEEN = {"PATH": os.path.dirname(sys.executable) + os.pathsep + os.environ["PATH"]}
RANKS = {name: "1" for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe")}

TASK = """
import os
import random
import numpy as np
import libdyn

def evaluate(model, inputs):
    tau = libdyn.rnea(model, libdyn.Data(model), inputs["q"], inputs["v"], inputs["a"])
    return {"tau": tau, "third": inputs["values.gain"] / 3, "noise": np.random.rand(2) + random.random(), "mass": model.mass}

def fragile(model, inputs):
    k = int(inputs["values.k"][0])
    if k == 1:
        raise RuntimeError("no luck")
    if k == 2:
        return {"y": [1, 2]}
    if k == 3:
        return {"z": 1}
    if k == 4:
        return [1]
    if k == 5:
        return {"y": "text"}
    if k == 6:
        os._exit(3)
    if k == 7:
        os.kill(os.getpid(), 9)
    if k == 8:
        raise SystemExit(4)
    if k == 9:
        return {"y": float("nan")}
    print("text for standard error")
    return {"y": k / 3}

def process(model, inputs):
    return {"pid": os.getpid()}

def waiting(model, inputs):
    here = os.path.dirname(__file__)
    if inputs["values.k"][0] == 7 and os.path.exists(here + "/wait"):
        with open(here + "/pid.part", "w") as file:
            file.write(str(os.getpid()))
        os.rename(here + "/pid.part", here + "/pid")
        while True:
            pass
    return {"y": inputs["values.k"] / 3}

def never(model, inputs):
    raise ValueError("not today")

def reserved(model, inputs):
    return {"failed": 1}
"""


def gone(pid):
    """Whether no such process is there; one that waits for its parent counts as there."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return True
    return False


class PythonTasks(SweepTest):
    def setUp(self):
        super().setUp()
        (self.folder / "task.py").write_text(TASK, encoding="utf-8")

    def study(self, name="study.json", **members):
        """Writes a study and returns its path."""
        study = dict({"model": str(ARM), "task": "python", "file": "task.py", "samples": 30, "seed": 3, "chunk": 4,
                      "vary": {"q": {"uniform": "limits"}, "v": {"normal": [0, 1]}, "values": {"gain": {"uniform": [0, 1]}}}}, **members)
        path = self.folder / name
        path.write_text(json.dumps(study), encoding="utf-8")
        return path

    def samples(self, function, count, **members):
        return self.study(function=function, vary={"values": {"k": {"grid": [0, count - 1, count]}}}, samples=count, **members)

    def dyn(self, *words, env=None, code=0):
        done = subprocess.run([sweeps._command(), "sweep", *map(str, words)], env={**os.environ, **SEEN, **(env or {})}, capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def digest(self, name):
        return self.dyn("--digest", self.folder / name).stdout

    def test_a_function_gets_model_and_inputs_and_its_numbers_come_back_exactly(self):
        results = dyn.sweep(self.study(keep=["inputs"], success={"third": [0, 0.2]}), self.folder / "out", threads=2)
        model = dyn.compile(dyn.load(ARM), dissipation=False)
        data = dyn.Data(model)
        for k in (0, 13, 29):
            q, v = results["input/q"][k], results["input/v"][k]
            self.assertEqual(results["tau"][k].tolist(), dyn.rnea(model, data, q, v, np.zeros(model.nv)).tolist())
        self.assertEqual(results["third"].tolist(), (results["input/values.gain"] / 3).tolist())
        self.assertEqual(results["success"].tolist(), (results["third"][:, 0] <= 0.2).tolist())
        self.assertTrue(0 < results["success"].sum() < 30)
        self.assertEqual(results["mass"].tolist(), 30 * [model.mass])

    def test_results_have_the_same_bytes_for_every_number_of_threads_and_ranks(self):
        study = self.study()
        for threads in (1, 3):
            self.dyn(study, "--out", self.folder / str(threads), "--threads", threads)
        self.assertEqual(self.digest("1"), self.digest("3"))
        whole = (self.folder / "1" / "results.h5").read_bytes()
        self.assertEqual((self.folder / "3" / "results.h5").read_bytes(), whole)
        self.dyn(self.study("large.json", chunk=30), "--out", self.folder / "large")
        self.assertEqual(self.digest("large"), self.digest("1"))
        replay = json.loads(self.dyn("--replay", self.folder / "1", 17).stdout)["results"]
        results = dyn.sweep(study, self.folder / "again")
        self.assertEqual(replay["noise"], results["noise"][17].tolist())
        self.assertEqual(len(set(results["noise"].ravel().tolist())), 60)
        if shutil.which("mpirun"):
            words = ["mpirun", "-n", "2", sweeps._command(), "sweep", study, "--out", self.folder / "ranks"]
            done = subprocess.run(list(map(str, words)), env={**os.environ, **SEEN, **RANKS}, capture_output=True, text=True, check=False)
            if "without MPI" not in done.stderr:
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual((self.folder / "ranks" / "results.h5").read_bytes(), whole)

    def test_the_model_has_the_numbers_of_the_sample(self):
        vary = {"bodies": {"hand": {"mass": {"list": [1, 3]}, "com": [0, 0, 0.1]}}, "gravity": [0, 0, -1], "q": 0.3, "values": {"gain": [1, 2, 3]},
                "joints": {"wrist3": {"armature": 0.25, "damping": 0.5}}}
        results = dyn.sweep(self.study(vary=vary, samples=2, losses=True), self.folder / "out")
        model = dyn.load(ARM)
        hand = next(body for body in model.bodies if body.name == "hand")
        self.assertAlmostEqual(results["mass"][1] - results["mass"][0], 2 * hand.inertia.mass, delta=1e-12)
        heavy = dyn.Inertia(3 * hand.inertia.mass, hand.inertia.com + [0, 0, 0.1], 3 * hand.inertia.rotational)
        compiled = dyn.compile(model).with_numbers(inertias={"hand": heavy}, gravity=np.array([0, 0, -1]), armature={"wrist3": 0.25},
                                                   damping={"wrist3": 0.5})
        zero = np.zeros(compiled.nv)
        expected = dyn.rnea(compiled, dyn.Data(compiled), np.full(compiled.nq, 0.3), zero, zero)
        np.testing.assert_allclose(results["tau"][1], expected, rtol=1e-13, atol=1e-13)
        self.assertEqual(results["third"].shape, (2, 3))

    def test_the_model_has_the_limits_of_the_sample(self):
        with open(self.folder / "task.py", "a", encoding="utf-8") as file:
            file.write("\ndef limits(model, inputs):\n    return {'lower': model.lower, 'upper': model.upper, 'velocity': model.velocity_limit, "
                       "'effort': model.effort_limit, 'armature': libdyn.crba(model, libdyn.Data(model), inputs['q'])[6, 6]}\n")
        vary = {"joints": {"wrist3": {"lower": {"list": [-0.5, -0.25]}, "effort": 3, "velocity": {"uniform": [1, 2]}, "armature": 0.25}}}
        results = dyn.sweep(self.study(function="limits", vary=vary, samples=4, keep=["inputs"]), self.folder / "out", threads=2)
        self.assertEqual(results["failed"].sum(), 0)
        model = dyn.compile(dyn.load(ARM))
        self.assertEqual(results["lower"][:, 6].tolist(), [-0.5, -0.25, -0.5, -0.25])
        self.assertEqual(results["effort"][:, 6].tolist(), 4 * [3])
        self.assertEqual(results["velocity"][:, 6].tolist(), results["input/joints.wrist3.velocity"][:, 0].tolist())
        self.assertEqual(results["upper"].tolist(), 4 * [model.upper.tolist()])
        self.assertEqual(results["effort"][:, :6].tolist(), 4 * [model.effort_limit[:6].tolist()])
        self.assertTrue((results["armature"] > 0.25).all())

    def test_samples_that_raise_or_give_other_results_or_end_the_process_fail_alone(self):
        for threads in (1, 3):
            out = self.folder / f"out{threads}"
            done = self.dyn(self.samples("fragile", 12), "--out", out, "--threads", threads)
            self.assertIn("12 samples, 9 failed", done.stdout)
            self.assertIn("text for standard error", done.stderr)
            reasons = {x["sample"]: x["reason"] for x in map(json.loads, (out / "failures.jsonl").read_text(encoding="utf-8").splitlines())}
            self.assertEqual(sorted(reasons), list(range(1, 10)))
            for k, text in {1: "RuntimeError: no luck (task.py, line 14)", 2: "'y' has the shape [2], and that of the first sample []",
                            3: "there is no result 'y'", 4: "fragile must return a dict of numbers and arrays, not list",
                            5: "the result 'y' is no number", 6: "python3 ended with exit code 3", 7: "python3 was ended by a signal: Killed",
                            8: "SystemExit: 4", 9: "y is not finite"}.items():
                self.assertIn(text, reasons[k])
        self.assertEqual(self.digest("out1"), self.digest("out3"))
        results = dyn.sweep(self.samples("fragile", 12), self.folder / "again")
        self.assertEqual(results["y"][[0, 10, 11]].tolist(), [0, 10 / 3, 11 / 3])
        self.assertTrue(np.isnan(results["y"][1:10]).all())

    def test_the_first_sample_that_has_results_decides_what_they_are(self):
        study = self.study(function="fragile", vary={"values": {"k": {"list": [6, 1, 2, 0]}}}, samples=4)
        results = dyn.sweep(study, self.folder / "out")
        self.assertEqual(results["y"].shape, (4, 2))
        self.assertEqual(results["failed"].tolist(), [1, 1, 0, 1])

    def test_a_file_that_cannot_be_used_is_named_before_the_sweep_begins(self):
        (self.folder / "broken.py").write_text("x = 1\ndef (:\n", encoding="utf-8")
        for members, message in ((dict(function="evaluat"), "task.py: has no function 'evaluat'; there are evaluate, fragile"),
                                 (dict(file="no.py"), "no.py: does not exist"), (dict(file="broken.py"), "SyntaxError: invalid syntax"),
                                 (dict(function="never"), "fails for every sample that was tried; for sample 0: ValueError: not today"),
                                 (dict(function="reserved"), "'failed' is no name of a result"),
                                 (dict(vary={"values": {"a/b": 1}}), "vary.values: 'a/b' is no name"),
                                 (dict(success={"thirds": [0, 1]}), "there is no kept result 'thirds'; did you mean 'third'?"),
                                 (dict(functions=["M"]), "no member 'functions'; did you mean 'function'?")):
            with self.subTest(message):
                done = self.dyn(self.study(**members), "--out", self.folder / "out", code=1)
                self.assertIn(message, done.stderr)
                self.assertFalse((self.folder / "out").exists())
        self.assertIn("file: must be a text", self.dyn(self.study(file=None), "--out", self.folder / "out", code=1).stderr)

    def test_a_python3_that_is_missing_or_has_no_module_is_named_before_the_sweep_begins(self):
        programs = self.folder / "programs"
        programs.mkdir()
        study = self.study()
        message = self.dyn(study, "--out", self.folder / "out", env={"PATH": str(programs)}, code=1).stderr
        self.assertIn("there is no python3 to run it", message)
        bare = programs / "python3"
        bare.write_text(f'#!/bin/sh\nexec "{sys.executable}" -I -S "$@"\n', encoding="utf-8")
        bare.chmod(0o755)
        message = self.dyn(study, "--out", self.folder / "out", env={"PATH": f"{programs}:/usr/bin:/bin"}, code=1).stderr
        self.assertIn("python3 has no module libdyn", message)
        self.assertFalse((self.folder / "out").exists())

    def test_a_sweep_does_not_go_on_with_another_text_of_the_file(self):
        study = self.study()
        self.dyn(study, "--out", self.folder / "out")
        with open(self.folder / "task.py", "a", encoding="utf-8") as file:
            file.write("\n")
        self.assertIn("another text of the Python file", self.dyn(study, "--out", self.folder / "out", "--resume", code=1).stderr)
        self.assertIn("another text of the Python file", self.dyn("--replay", self.folder / "out", 1, code=1).stderr)

    def test_each_thread_has_one_process_and_none_is_left(self):
        results = dyn.sweep(self.samples("process", 40, chunk=2), self.folder / "out", threads=3)
        pids = {int(pid) for pid in results["pid"]}
        self.assertLessEqual(len(pids), 3)
        self.assertTrue(all(map(gone, pids)))

    def test_an_interrupted_sweep_ends_its_processes_and_goes_on_with_the_same_results(self):
        study = self.samples("waiting", 12)
        self.dyn(study, "--out", self.folder / "whole")
        for number in (signal.SIGINT, signal.SIGKILL):
            (self.folder / "wait").touch()
            out = self.folder / f"cut{int(number)}"
            with subprocess.Popen([sweeps._command(), "sweep", study, "--out", out, "--threads", "2"], env={**os.environ, **SEEN},
                                  stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as job:
                while not (self.folder / "pid").exists() and job.poll() is None:
                    time.sleep(0.01)
                job.send_signal(number)
            self.assertEqual(job.returncode, 130 if number == signal.SIGINT else -9)
            pid = int((self.folder / "pid").read_text(encoding="utf-8"))
            for name in ("wait", "pid"):
                (self.folder / name).unlink()
            # The kernel ends it when dyn is killed, which takes a moment; whoever then is its parent has to notice.
            while number == signal.SIGKILL and pathlib.Path(f"/proc/{pid}").exists() and \
                    "State:\tZ" not in pathlib.Path(f"/proc/{pid}/status").read_text(encoding="utf-8"):
                time.sleep(0.01)
            self.assertTrue(number == signal.SIGKILL or gone(pid))
            self.dyn(study, "--out", out, "--resume")
            self.assertEqual(self.digest(out.name), self.digest("whole"))


if __name__ == "__main__":
    unittest.main()
