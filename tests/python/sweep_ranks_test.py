# SPDX-License-Identifier: BSD-2-Clause
"""Sweeps in the ranks of a communicator of mpi4py: the same bytes as in one process, errors on all ranks, and ranks that die."""
import importlib.util
import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

import libdyn as dyn
from sweeping import ARM, SweepTest

RANKS = {name: "1" for name in ("OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe")}

PROGRAM = """
import json, os, subprocess, sys
import libdyn
from mpi4py import MPI

comm = MPI.COMM_WORLD
{body}
"""

SHARED = """
def attempt(study, out, **options):
    try:
        results = libdyn.sweep(study, out, comm=comm, **options)
        return sorted(results), None
    except libdyn.Error as problem:
        return [], str(problem)

study, out = json.loads(sys.argv[1]), sys.argv[2]
{body}
told = comm.gather(told, root=0)
if comm.rank == 0:
    print(json.dumps(told))
"""


class SweepsInRanks(SweepTest):
    def setUp(self):
        super().setUp()
        if importlib.util.find_spec("mpi4py") is None or not shutil.which("mpirun"):
            if os.environ.get("DYN_REQUIRE_ALL") == "1":
                self.fail("mpi4py or mpirun is missing")
            self.skipTest("mpi4py or mpirun is missing (Debian: python3-mpi4py, openmpi-bin)")

    def mpirun(self, ranks, body, *words):
        """Runs a program in ranks and returns what it prints."""
        path = self.folder / "program.py"
        path.write_text(PROGRAM.format(body=body), encoding="utf-8")
        done = subprocess.run(["mpirun", "-n", str(ranks), sys.executable, "-B", path, *map(str, words)], env={**os.environ, **RANKS}, check=False,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def told(self, ranks, study, out, body="told = attempt(study, out)"):
        return json.loads(self.mpirun(ranks, SHARED.format(body=body), json.dumps(study), self.folder / out))

    def study(self, **members):
        return dict({"model": str(ARM), "task": "simulate", "time": 0.02, "samples": 60, "seed": 3, "chunk": 4,
                     "vary": {"q": {"uniform": "limits"}, "v": {"uniform": [-1, 1]}}, "keep": ["final"]}, **members)

    def results(self, name):
        return (self.folder / name / "results.h5").read_bytes()

    def test_the_ranks_of_a_communicator_have_the_results_of_one_process_to_the_byte(self):
        names = sorted(dyn.sweep(self.study(), self.folder / "one"))
        for ranks in (1, 2, 3):
            told = self.told(ranks, self.study(), f"ranks{ranks}")
            self.assertEqual(told, [[names, None]] + (ranks - 1) * [[[], None]])
            self.assertEqual(self.results(f"ranks{ranks}"), self.results("one"))

    def test_a_study_may_be_a_file_and_threads_and_resume_act(self):
        path = self.folder / "study.json"
        path.write_text(json.dumps(self.study()), encoding="utf-8")
        dyn.sweep(path, self.folder / "one")
        told = self.told(2, str(path), "two", "told = attempt(study, out, threads=2), attempt(study, out, resume=True), attempt(study, out)")
        self.assertEqual(self.results("two"), self.results("one"))
        for first, again, refused in told:
            self.assertEqual(first, again)
            self.assertIn("there is a sweep in this folder", refused[1])

    def test_a_function_of_a_python_file_runs_in_ranks(self):
        (self.folder / "task.py").write_text("def evaluate(model, inputs):\n    return {'y': inputs['q'] / 3}\n", encoding="utf-8")
        study = {"model": str(ARM), "task": "python", "file": str(self.folder / "task.py"), "samples": 9, "chunk": 2,
                 "vary": {"q": {"uniform": "limits"}}}
        dyn.sweep(study, self.folder / "one")
        self.told(2, study, "two")
        self.assertEqual(self.results("two"), self.results("one"))

    def test_a_wrong_study_or_another_one_on_some_rank_is_an_error_on_all_ranks(self):
        for told in self.told(3, self.study(vary={"Q": 1}), "out"):
            self.assertIn("vary: there is no quantity 'Q'", told[1])
        other = "study['seed'] += comm.rank == 2\ntold = attempt(study, out)"
        for told in self.told(3, self.study(), "out", other):
            self.assertIn("rank 2: it has another version of libdyn, instruction set, study", told[1])
        self.assertFalse((self.folder / "out").exists())
        unreadable = "study = {1, 2} if comm.rank == 1 else study\ntry:\n    told = attempt(study, out)\nexcept TypeError:\n    told = [], 'type'"
        self.assertEqual([text for _, text in self.told(2, self.study(), "out", unreadable)],
                         ["another rank cannot begin the sweep; its own error says why", "type"])

    def test_a_command_that_is_killed_ends_the_sweep_on_all_ranks_and_resume_goes_on(self):
        study = self.study(samples=20000, chunk=100)
        kill = """
class Killed(subprocess.Popen):
    def poll(self):
        if self.returncode is None and os.path.exists(out + "/chunks/5"):
            os.kill(self.pid, 9)
        return super().poll()

if comm.rank == 1:
    subprocess.Popen = Killed
told = attempt(study, out)
"""
        for told in self.told(2, study, "cut", kill):
            self.assertIn("rank 1: dyn was ended by signal 9", told[1])
        self.assertFalse((self.folder / "cut" / "results.h5").exists())
        dyn.sweep(study, self.folder / "cut", resume=True)
        dyn.sweep(study, self.folder / "one")
        self.assertEqual(self.results("cut"), self.results("one"))

    def test_without_a_communicator_a_rank_sweeps_alone(self):
        dyn.sweep(self.study(), self.folder / "one")
        self.mpirun(2, "libdyn.sweep(json.loads(sys.argv[1]), sys.argv[2] + str(comm.rank))", json.dumps(self.study()), self.folder / "alone")
        for rank in (0, 1):
            self.assertEqual(self.results(f"alone{rank}"), self.results("one"))


if __name__ == "__main__":
    unittest.main()
