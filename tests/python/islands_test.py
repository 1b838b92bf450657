# SPDX-License-Identifier: BSD-2-Clause
"""Scenes that are simulated island by island."""
import unittest

import numpy as np

import libdyn as dyn
from interrupting import interrupted_advance


def scene():
    """Returns two pendulums, the second one damped."""
    model = dyn.Model()
    for k, damping in enumerate((0.0, 5.0)):
        joint = dyn.JointDescription(f"hinge{k}", "revolute", {"axis": [0, 1, 0]}, dyn.SE3.translation(0, k, 0))
        joint.damping = damping
        model.add_body(f"rod{k}", 0, joint, dyn.Inertia(1.0, [0, 0, -0.5], 0.02 * np.eye(3)))
    return model


class Islands(unittest.TestCase):
    def test_each_island_moves_as_in_the_whole_scene(self):
        whole = dyn.Simulator(dyn.compile(scene()), dt=1e-3)
        whole.reset([0.3, 0.5], [0.0, 0.0])
        whole.advance(0.5)
        islands = dyn.IslandSimulator(scene(), dt=1e-3)
        self.assertEqual((len(islands), islands.island_of("rod1"), islands.island_of("no")), (2, 1, -1))
        for k, q in enumerate((0.3, 0.5)):
            islands.island(k).reset([q], [0.0])
        islands.advance(0.5)
        self.assertEqual(islands.time, 0.5)
        np.testing.assert_allclose([islands.island(k).q[0] for k in range(2)], whole.q, atol=1e-12)
        self.assertIn("islands: 2", islands.report)

    def test_islands_at_rest_fall_asleep_and_wake(self):
        islands = dyn.IslandSimulator(scene(), dt=1e-3, sleep=True, sleep_speed=1e-3, sleep_time=0.2)
        islands.island(0).reset([0.3], [0.0])
        islands.advance(2.0)
        self.assertEqual([islands.asleep(k) for k in range(2)], [False, True])
        steps = islands.island(1).statistics["steps"]
        islands.advance(3.0)
        self.assertEqual(islands.island(1).statistics["steps"], steps)
        islands.island(1).set_controller(lambda t, q, v: [1.0])
        islands.wake(1)
        islands.advance(4.0)
        self.assertFalse(islands.asleep(1))
        self.assertGreater(abs(islands.island(1).q[0]), 0.01)

    def test_the_wanted_parts_of_a_scene(self):
        self.assertEqual(dyn.islands_of(scene()), ["rod0", "rod1"])
        self.assertEqual(len(dyn.islands_of(scene(), ["rod0", "rod1"])), 1)
        kept, report = dyn.keep_for_scene(scene(), ["rod1"])
        self.assertEqual([body.name for body in kept.bodies], ["universe", "rod1"])
        self.assertTrue(report)
        self.assertEqual(len(dyn.IslandSimulator(scene(), outputs=["rod1"])), 1)

    def test_errors_and_exceptions_arrive(self):
        islands = dyn.IslandSimulator(scene())
        with self.assertRaises(dyn.Error):
            islands.island(2)
        with self.assertRaisesRegex(dyn.Error, "time goes forward"):
            islands.advance(-1.0)
        with self.assertRaises(dyn.Error):
            dyn.IslandSimulator(scene(), sleep=True, sleep_time=0)

        def controller(t, q, v):
            raise KeyError("mine")

        island = islands.island(1)
        island.set_controller(controller)
        with self.assertRaisesRegex(KeyError, "mine"):
            islands.advance(1.0)
        self.assertEqual(islands.time, 0.0)
        del islands
        self.assertEqual(island.model.nv, 1)

    def test_the_user_interrupts_islands_without_callbacks(self):
        islands = dyn.IslandSimulator(scene(), dt=1e-4)
        interrupted_advance(self, islands, 1e6, watched=islands.island(0))
        self.assertLess(islands.time, 1e6)
        islands.advance(islands.time + 1e-3)


if __name__ == "__main__":
    unittest.main()
