# SPDX-License-Identifier: BSD-2-Clause
"""Many trajectories at once: the same numbers as a Simulator's, for any number of threads."""
import os
import pathlib
import signal
import threading
import time
import unittest

import numpy as np

import libdyn as dyn
from robots import ball

ARM = pathlib.Path(__file__).parents[2] / "models" / "arm.urdf"


def arm():
    return dyn.compile(dyn.load(ARM))


def controls_of(model, trajectories, steps):
    return np.random.default_rng(1).normal(size=(trajectories, steps, model.nv))


class Rollouts(unittest.TestCase):
    def test_each_trajectory_is_that_of_a_simulator(self):
        model = arm()
        controls = controls_of(model, 3, 5)
        q0 = np.stack([dyn.random_configuration(model, k) for k in range(3)])
        v0 = np.random.default_rng(2).normal(size=(3, model.nv))
        for integrator in ("semi_implicit_euler", "rk4", "dormand_prince", "gauss6", "variational"):
            q, v = dyn.rollout(model, q0, v0, controls, 0.01, integrator)
            self.assertEqual((q.shape, v.shape), ((3, 6, model.nq), (3, 6, model.nv)))
            for k in range(3):
                simulator = dyn.Simulator(model, integrator, 0.01)
                simulator.reset(q0[k], v0[k])
                for i in range(5):
                    np.testing.assert_array_equal(q[k, i], simulator.q)
                    np.testing.assert_array_equal(v[k, i], simulator.v)
                    zero = np.zeros((model.nv, model.nv))
                    simulator.set_controller(lambda t, q, v: controls[k, i], lambda t, q, v: (zero, zero))
                    simulator.advance((i + 1) * 0.01)
                np.testing.assert_array_equal(q[k, 5], simulator.q)

    def test_the_number_of_threads_changes_no_bit(self):
        model = arm()
        controls = controls_of(model, 17, 20)
        one = dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 0.01)
        for threads in (2, 3, 20):
            more = dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 0.01, threads=threads)
            np.testing.assert_array_equal(one[0], more[0])
            np.testing.assert_array_equal(one[1], more[1])

    def test_controls_of_any_layout_and_no_controls_at_all(self):
        model = arm()
        controls = controls_of(model, 4, 6)
        expected = dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 0.01)[0]
        for form in (np.asfortranarray(controls), controls.tolist(), np.repeat(controls, 2, axis=1)[:, ::2]):
            np.testing.assert_array_equal(dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), form, 0.01)[0], expected)
        for shape in ((0, 5, model.nv), (3, 0, model.nv)):
            q, v = dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), np.zeros(shape), 0.01)
            self.assertEqual(q.shape, (shape[0], shape[1] + 1, model.nq))
        np.testing.assert_array_equal(q, np.broadcast_to(dyn.neutral(model), q.shape))

    def test_a_batch_stepper_takes_the_same_steps(self):
        model, n, steps = arm(), 5, 4
        controls = np.random.default_rng(3).normal(size=(steps, n, model.nv))
        q0, v0 = dyn.random_configuration(model, 1, n), np.random.default_rng(4).normal(size=(n, model.nv))
        for integrator in ("explicit_euler", "semi_implicit_euler", "rk4"):
            stepper = dyn.BatchStepper(model, n, integrator, threads=2)
            q, v = stepper.rollout(1e-3, q0, v0, controls)
            expected_q, expected_v = dyn.rollout(model, q0, v0, controls.transpose(1, 0, 2), 1e-3, integrator)
            np.testing.assert_allclose(q.transpose(1, 0, 2), expected_q[:, 1:], atol=1e-10)
            np.testing.assert_allclose(v.transpose(1, 0, 2), expected_v[:, 1:], atol=1e-9)
        with self.assertRaises(dyn.Error):
            stepper.rollout(1e-3, q0[:2], v0, controls)
        with self.assertRaises(dyn.Error):
            dyn.BatchStepper(model, n, "gauss6")

    def test_constraints_hold_in_rollouts(self):
        model = arm()
        held = dyn.ConstraintSet(model, [dyn.lock_joint(model.joints[1].name)])
        q, _ = dyn.rollout(held, dyn.neutral(model), np.zeros(model.nv), controls_of(model, 2, 10), 0.01, threads=2)
        np.testing.assert_allclose(q[:, :, 0], 0, atol=1e-12)

    def test_contacts_are_found_by_a_finder_for_each_thread(self):
        description = ball()
        model = dyn.compile(description)
        volumes = dyn.compile_geometry(model, description)
        q0 = np.tile(dyn.neutral(model), (6, 1))
        q0[:, 2] = np.linspace(0.12, 0.3, 6)
        made = []

        def contacts():
            made.append(dyn.geometry_contacts(model, volumes))
            return made[-1]

        arguments = (model, q0, np.zeros(6), np.zeros((6, 500, 6)), 1e-3)
        one = dyn.rollout(*arguments, contacts=contacts)[0]
        np.testing.assert_allclose(one[:, -1, 2], 0.1, atol=1e-3)
        self.assertEqual(len(made), 1)
        np.testing.assert_array_equal(dyn.rollout(*arguments, threads=3, contacts=contacts)[0], one)
        self.assertEqual(len(made), 4)
        with self.assertRaisesRegex(dyn.Error, "a new finder"):
            dyn.rollout(*arguments, threads=2, contacts=lambda: made[0])

    def test_wrong_arguments_are_named(self):
        model = arm()
        q, v, controls = dyn.neutral(model), np.zeros(model.nv), controls_of(model, 2, 3)
        for arguments, message in (
            ((q, v, controls[0], 0.01), r"controls has the shape \(3, "),
            ((q[1:], v, controls, 0.01), "q0 has the shape"),
            ((np.stack([q] * 3), v, controls, 0.01), r"q0 has the shape \(3, "),
            ((q, v[1:], controls, 0.01), "v0 has the shape"),
            ((q, v, controls, -1.0), "dt"),
            ((q, v, controls, 0.01, "rk5"), "rk4"),
            ((q, v, controls, 0.01, "rk4", 0), "0 threads"),
        ):
            with self.assertRaisesRegex(dyn.Error, message):
                dyn.rollout(model, *arguments)
        for wrong in ("a", controls + 1j, None):
            with self.assertRaisesRegex(TypeError, "rollout: controls must be an array of numbers"):
                dyn.rollout(model, q, v, wrong, 0.01)
        with self.assertRaisesRegex(dyn.Error, "diverged is 'x'"):
            dyn.rollout(model, q, v, controls, 0.01, diverged="x")

    def test_a_trajectory_that_cannot_go_on_is_an_error_or_nan(self):
        model = arm()
        controls = controls_of(model, 5, 4)
        controls[3, 2] = np.inf
        with self.assertRaisesRegex(dyn.Error, "3") as caught:
            dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 0.01, threads=2)
        self.assertEqual(caught.exception.code, "simulation")
        q, v = dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 0.01, threads=2, diverged="nan")
        self.assertTrue(np.all(np.isfinite(q[[0, 1, 2, 4]])) and np.all(np.isfinite(q[3, :3])))
        self.assertTrue(np.all(np.isnan(q[3, 3:])) and np.all(np.isnan(v[3, 3:])))

    def test_other_threads_run_and_the_user_can_interrupt(self):
        model = arm()
        controls = np.zeros((2, 200000, model.nv))
        turns = []

        def interrupt():
            while len(turns) < 50:
                turns.append(None)
                time.sleep(0.001)
            os.kill(os.getpid(), signal.SIGINT)

        thread = threading.Thread(target=interrupt)
        with self.assertRaises(KeyboardInterrupt):
            thread.start()
            dyn.rollout(model, dyn.neutral(model), np.zeros(model.nv), controls, 1e-4, threads=2)
        thread.join()
        self.assertEqual(len(turns), 50)


if __name__ == "__main__":
    unittest.main()
