# SPDX-License-Identifier: BSD-2-Clause
"""Sweeps from Python: the arrays of dyn sweep, with and without h5py."""
import json
import unittest
from unittest import mock

import numpy as np

import libdyn as dyn
from libdyn import sweeps
from sweeping import ARM, SweepTest


def study(**members):
    return dict({"model": str(ARM), "task": "simulate", "time": 0.01, "samples": 12, "seed": 3, "chunk": 5,
                 "vary": {"q": {"uniform": "limits"}, "v": {"uniform": [-1, 1]}}, "keep": ["initial", "final"]}, **members)


class Sweeps(SweepTest):
    def test_each_sample_is_what_a_simulator_gives(self):
        results = dyn.sweep(study(), self.folder / "out", threads=2)
        self.assertEqual(results["q_final"].shape, (12, 7))
        self.assertEqual(results["success"].tolist(), 12 * [1])
        simulator = dyn.Simulator(dyn.compile(dyn.load(ARM)), integrator="rk4", dt=1e-3)
        for k in (0, 11):
            simulator.reset(results["q_initial"][k], results["v_initial"][k])
            simulator.advance(0.01)
            np.testing.assert_allclose(simulator.q, results["q_final"][k], rtol=1e-12, atol=1e-12)

    def test_results_are_the_same_without_h5py_and_after_a_restart(self):
        results = dyn.sweep(study(), self.folder / "one")
        with mock.patch.object(sweeps, "_h5py", lambda: None):
            parts = dyn.sweep(study(), self.folder / "two", threads=1)
            again = dyn.sweep(study(), self.folder / "two", resume=True)
            with self.assertRaisesRegex(dyn.Error, "h5py"):
                dyn.sweep(study(), self.folder / "one", resume=True)
        for other in (parts, again):
            self.assertEqual(set(other), set(results))
            for name in results:
                np.testing.assert_array_equal(other[name], results[name])

    def test_histograms_are_those_of_numpy_for_every_number_of_threads(self):
        # Every fourth sample fails, so that its results are NaN.
        members = study(samples=200, keep=["final", "inputs"],
                        histograms={"v_final": [-0.25, 0.5, 7], "failed": [0, 1, 2], "input/tau": [0, 1, 1]})
        members["vary"] = dict(members["vary"], tau={"list": [0, 0.5, 1, 1e200]})
        results = dyn.sweep(members, self.folder / "one", threads=1)
        if "histogram/v_final/counts" not in results:
            self.skipTest("h5py is missing")
        again = dyn.sweep(dict(members, chunk=200), self.folder / "two", threads=3)
        edges = results["histogram/v_final/edges"]
        np.testing.assert_allclose(edges, np.linspace(-0.25, 0.5, 8), rtol=0, atol=1e-15)
        self.assertEqual((edges[0], edges[-1]), (-0.25, 0.5))
        for joint, v in enumerate(results["v_final"].T):
            self.assertEqual(results["histogram/v_final/counts"][joint].tolist(), np.histogram(v[~np.isnan(v)], edges)[0].tolist())
            self.assertEqual(results["histogram/v_final/outside"][joint].tolist(), [(v < -0.25).sum(), (v > 0.5).sum(), 50])
        self.assertTrue((results["histogram/v_final/outside"] > 0).all())
        self.assertEqual(results["histogram/failed/counts"].tolist(), [150, 50])
        # The upper end is in the last bin.
        self.assertEqual(results["histogram/input/tau/counts"].tolist(), 7 * [[150]])
        self.assertEqual(results["histogram/input/tau/outside"].tolist(), 7 * [[0, 50, 0]])
        for name, numbers in results.items():
            np.testing.assert_array_equal(again[name], numbers)

    def test_a_histogram_that_cannot_be_is_an_error_with_the_place(self):
        for given, message in (({"v_fin": [0, 1, 2]}, "histograms: there is no kept result 'v_fin'"),
                               ({"v_final": [0, 1]}, "must be .lower, upper, bins"),
                               ({"v_final": [1, 1, 2]}, "histograms.v_final: the lower end must be below"),
                               ({"v_final": [0, 1, 1.5]}, "has a whole number of bins"), ({"v_final": [0, 1, 2000000]}, "has a whole number of bins"),
                               ({"v_final": [1, 1.0000000000000002, 2]}, "the lower end must be below")):
            with self.assertRaisesRegex(dyn.Error, message):
                dyn.sweep(study(histograms=given), self.folder / "out")
        self.assertFalse((self.folder / "out").exists())

    def test_a_study_may_be_a_file_and_paths_are_relative_to_it(self):
        (self.folder / "arm.urdf").write_bytes(ARM.read_bytes())
        path = self.folder / "study.json"
        path.write_text(json.dumps(study(model="arm.urdf")))
        np.testing.assert_array_equal(dyn.sweep(path, self.folder / "a")["q_final"], dyn.sweep(study(), self.folder / "b")["q_final"])

    def test_a_wrong_study_is_an_error_with_the_place(self):
        with self.assertRaisesRegex(dyn.Error, "vary: there is no quantity 'Q'"):
            dyn.sweep(study(vary={"Q": 1}), self.folder / "out")
        dyn.sweep(study(), self.folder / "out")
        with self.assertRaisesRegex(dyn.Error, "there is a sweep in this folder"):
            dyn.sweep(study(), self.folder / "out")


if __name__ == "__main__":
    unittest.main()
