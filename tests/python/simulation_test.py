# SPDX-License-Identifier: BSD-2-Clause
"""Constraints, volumes and simulations in Python."""
import os
import signal
import threading
import unittest

import numpy as np

import libdyn as dyn
from interrupting import interrupted_advance
from robots import ball


def pendulum():
    model = dyn.Model()
    model.add_body("rod", 0, dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]}), dyn.Inertia(2.0, [0, 0, -1.0], 0.01 * np.eye(3)))
    model.add_frame("tip", "rod", dyn.SE3.translation(0, 0, -1))
    return model


class Constraints(unittest.TestCase):
    def test_a_held_tip_carries_the_weight(self):
        model = dyn.compile(pendulum())
        data = dyn.Data(model)
        held = dyn.ConstraintSet(model, [dyn.lock_joint("hinge")])
        self.assertEqual((len(held), held.rows, held.rows_of(0)), (1, 1, slice(0, 1, 1)))
        forces = dyn.ConstraintData(held)
        motion = dyn.constraint_dynamics(model, data, [0.5], [0.0], [0.0], forces)
        np.testing.assert_allclose(motion.ddq, 0, atol=1e-12)
        np.testing.assert_allclose(motion.forces, dyn.generalized_gravity(model, data, [0.5]), atol=1e-12)
        impact = dyn.impulse_dynamics(model, data, [0.5], [2.0], 0.5, forces)
        np.testing.assert_allclose(impact.v_after, -1.0, atol=1e-12)
        np.testing.assert_allclose(dyn.compute_constraint_jacobian(model, data, [0.5], forces), [[1.0]])
        np.testing.assert_allclose(dyn.compute_constraint_motion(model, data, [0.5], [2.0], forces)[0], [2.0])
        with self.assertRaisesRegex(dyn.Error, "did you mean 'hinge'"):
            dyn.ConstraintSet(model, [dyn.lock_joint("hinges")])


class Geometry(unittest.TestCase):
    def test_distances_contacts_and_derivatives(self):
        description = ball()
        model = dyn.compile(description)
        volumes = dyn.compile_geometry(model, description)
        self.assertEqual(volumes.names, ["ball_volume", "ground"])
        data, placed = dyn.Data(model), dyn.GeometryData(volumes)
        q = dyn.neutral(model)
        q[2] = 0.5
        dyn.update_geometry_placements(model, data, volumes, placed, q)
        nearest = dyn.compute_minimum_distance(volumes, placed)
        self.assertAlmostEqual(nearest.distance, 0.4)
        self.assertFalse(dyn.any_collision(volumes, placed))
        np.testing.assert_allclose(np.abs(dyn.compute_distance_derivative(model, data, volumes, placed, nearest)[:3]), [0, 0, 1], atol=1e-12)
        q[2] = 0.05
        dyn.update_geometry_placements(model, data, volumes, placed, q)
        self.assertEqual(dyn.compute_collisions(volumes, placed), [0])
        (contact,) = dyn.compute_contacts(volumes, placed)
        self.assertAlmostEqual(contact.depth, 0.05)
        fcl = dyn.compile_geometry(model, description, all_pairs=False)
        self.assertEqual(fcl.pairs, [])


class Simulation(unittest.TestCase):
    def test_energy_is_kept_and_states_are_saved_without_loss(self):
        model = dyn.compile(pendulum())
        simulator = dyn.Simulator(model, integrator="gauss6", dt=1e-2)
        simulator.reset([1.0], [0.0])
        before = simulator.energy
        simulator.advance(1.0)
        self.assertAlmostEqual(simulator.energy, before, places=7)
        saved = simulator.save()
        simulator.advance(2.0)
        other = dyn.Simulator(model, integrator="gauss6", dt=1e-2)
        other.resume(saved)
        other.advance(2.0)
        np.testing.assert_array_equal(other.q, simulator.q)
        self.assertEqual(simulator.statistics["steps"], 200)

    def test_controllers_forces_events_and_observers(self):
        model = dyn.compile(pendulum())
        data = dyn.Data(model)
        simulator = dyn.Simulator(model, dt=1e-3)
        simulator.reset([0.7], [0.0])
        simulator.set_controller(lambda t, q, v: dyn.generalized_gravity(model, data, q))
        simulator.advance(0.1)
        np.testing.assert_allclose(simulator.q, [0.7], atol=1e-12)
        simulator.set_controller(None)
        simulator.reset([0.7], [0.0])
        simulator.set_events([("bottom", lambda t, q, v: q[0], "falling")])
        seen = []
        self.assertEqual(simulator.advance(5.0, [0.01, 0.02], lambda t, q, v: seen.append((t, q[0]))), 0)
        self.assertEqual([t for t, _ in seen], [0.01, 0.02])
        self.assertLess(abs(simulator.q[0]), 1e-9)
        simulator.set_events([])
        simulator.reset([0.0], [0.0])
        simulator.set_forces(lambda t, q, v: [[0] * 6, [0, 0, 0, 0, 1.5, 0]])
        np.testing.assert_allclose(simulator.acceleration, [1.5 / 2.01])

    def test_an_exception_of_a_callback_arrives_and_the_state_stays(self):
        simulator = dyn.Simulator(dyn.compile(pendulum()))

        def controller(t, q, v):
            if t > 0.01:
                raise KeyError("mine")
            return [0.0]

        simulator.set_controller(controller)
        with self.assertRaisesRegex(KeyError, "mine"):
            simulator.advance(1.0)
        self.assertLess(simulator.time, 0.011)
        simulator.set_controller(lambda t, q, v: [0.0, 1.0])
        with self.assertRaisesRegex(dyn.Error, "the controller returned 2 numbers, not 1"):
            simulator.step()
        simulator.set_controller(lambda t, q, v: simulator.step())
        with self.assertRaises(dyn.Error):
            simulator.step()
        with self.assertRaisesRegex(dyn.Error, "rk4"):
            dyn.Simulator(dyn.compile(pendulum()), integrator="rk5")

    def test_interrupting_a_simulation_ends_it(self):
        simulator = dyn.Simulator(dyn.compile(pendulum()), dt=1e-4)
        ready = threading.Event()

        def controller(t, q, v):
            ready.set()
            return [0.0]

        def interrupt():
            ready.wait()
            os.kill(os.getpid(), signal.SIGINT)

        simulator.set_controller(controller)
        thread = threading.Thread(target=interrupt)
        thread.start()
        with self.assertRaises(KeyboardInterrupt):
            simulator.advance(1e6)
        thread.join()

    def test_the_user_interrupts_a_simulation_without_callbacks(self):
        simulator = dyn.Simulator(dyn.compile(pendulum()), dt=1e-4)
        interrupted_advance(self, simulator, 1e6)
        reached = simulator.time
        self.assertLess(reached, 1e6)
        simulator.advance(reached + 1.0)

    def test_integrators_say_what_they_are(self):
        known = {x.name: x for x in dyn.integrators()}
        self.assertEqual((known["rk4"].order, known["rk4"].adaptive, known["radau5"].implicit), (4, False, True))
        for name in known:
            self.assertEqual(dyn.Simulator(dyn.compile(pendulum()), name).integrator, name)

    def test_looking_for_interruptions_changes_no_step(self):
        for integrator in ("rk4", "dormand_prince", "implicit_midpoint"):
            watched, stepped = (dyn.Simulator(dyn.compile(pendulum()), integrator, 1e-3) for _ in range(2))
            for simulator in (watched, stepped):
                simulator.reset([1.0], [0.5])
            while stepped.time < 2.0:
                stepped.step()
            watched.advance(stepped.time)
            self.assertEqual(watched.statistics["steps"], stepped.statistics["steps"])
            np.testing.assert_allclose(watched.q, stepped.q, rtol=0, atol=1e-13)
            seen = []
            watched.reset([1.0], [0.5])
            watched.advance(2.0, [0.0, 0.5, 0.5, 2.0], lambda t, q, v: seen.append((t, q[0])))
            self.assertEqual([t for t, _ in seen], [0.0, 0.5, 0.5, 2.0])
            self.assertEqual(seen[-1][1], watched.q[0])
            with self.assertRaisesRegex(dyn.Error, "time 1 is 2.1 s"):
                watched.advance(3.0, [2.2, 2.1], lambda t, q, v: None)

    def test_derivatives_of_a_controller_speed_implicit_steps_up_and_change_no_motion(self):
        results = []
        for derivatives in (None, lambda t, q, v: ([[-2.0]], [[-0.5]])):
            simulator = dyn.Simulator(dyn.compile(pendulum()), "radau5", 0.01)
            simulator.reset([0.7], [0.0])
            simulator.set_controller(lambda t, q, v: -2.0 * q - 0.5 * v, derivatives)
            simulator.advance(0.5)
            results.append(simulator.q[0])
        self.assertAlmostEqual(results[0], results[1], places=9)
        simulator.set_controller(lambda t, q, v: -v, lambda t, q, v: ([[0.0, 1.0]], [[0.0]]))
        with self.assertRaisesRegex(dyn.Error, "derivatives of the controller returned 2 numbers"):
            simulator.step()
        with self.assertRaisesRegex(dyn.Error, "derivatives without a controller"):
            simulator.set_controller(None, lambda t, q, v: None)
        self.assertEqual((simulator.integrator, simulator.dt, simulator.model.nv), ("radau5", 0.01, 1))

    def test_a_ball_comes_to_rest_on_the_ground(self):
        description = ball()
        model = dyn.compile(description)
        simulator = dyn.Simulator(model, dt=1e-3)
        q = dyn.neutral(model)
        q[2] = 0.3
        simulator.reset(q, np.zeros(model.nv))
        simulator.set_contacts(dyn.geometry_contacts(model, dyn.compile_geometry(model, description), friction=0.5))
        simulator.advance(1.0)
        self.assertAlmostEqual(simulator.q[2], 0.1, places=4)
        self.assertTrue(simulator.touches)


if __name__ == "__main__":
    unittest.main()
