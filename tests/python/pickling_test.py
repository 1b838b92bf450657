# SPDX-License-Identifier: BSD-2-Clause
"""Descriptions and spatial quantities pass through pickles, copies and other processes without loss."""
import multiprocessing
import pathlib
import pickle
import unittest

import numpy as np

import libdyn as dyn

MODELS = pathlib.Path(__file__).parents[2] / "models"


def full():
    """Returns a description with something of every kind."""
    model = dyn.load(MODELS / "biped.urdf", root="free_flyer")
    model.gravity = [0.1, 0.2, -9.7]
    parts = [dyn.JointDescription("turn", "revolute", {"axis": [0, 0, 1]}), dyn.JointDescription("slide", "prismatic", {"axis": [1, 0, 0]})]
    composite = dyn.JointDescription("both", "composite", {"parts": parts}, dyn.SE3.exp(dyn.Motion([0.1, 0.2, 0.3], [0.4, 0.5, 0.6])))
    composite.damping, composite.lower = [0.1, 0.2], [-1.0, -0.3]
    model.add_body("hook", 0, composite, dyn.Inertia(0.1, [1 / 3, 0, 0], 0.1 * np.eye(3)))
    follower = dyn.JointDescription("follower", "revolute", {"axis": [0, 1, 0]})
    follower.couple("turn", parameters={"coefficients": [0.0, 0.5]})
    model.add_body("wheel", "hook", follower)
    model.add_frame("eye", "hook", dyn.SE3.translation(0, 0, 1 / 7))
    loop = dyn.close_loop("loop", "eye", "universe", [False, True, True, True, True, True])
    loop.baumgarte = (10.0, 1 / 3)
    model.add_constraint(loop)
    model.add_constraint(dyn.lock_joint("both", [0.1, 0.2]))
    model.add_constraint(dyn.couple_joint("wheel", "turn", parameters={"coefficients": [0.0, 1.0]}))
    for k, shape in enumerate(
        (
            dyn.Sphere(0.1),
            dyn.Box(1, 2, 3),
            dyn.Capsule(1, 2),
            dyn.Cylinder(1, 2),
            dyn.Cone(1, 2),
            dyn.HalfSpace([0, 0, 1], 0.5),
            dyn.ConvexHull(np.random.default_rng(1).normal(size=(5, 3))),
            dyn.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]),
            dyn.MeshFile("a.stl", convex=True),
            dyn.Voxels([[0, 0, 0]], 0.1),
            dyn.OctreeFile("a.bt"),
        )
    ):
        model.add_geometry(f"volume{k}", "hook", shape, role="visual" if k == 1 else "collision")
    model.disable_collision("hook", "universe", "never")
    return model


def torques(description):
    """Returns joint forces of a description; it runs in other processes."""
    model = dyn.compile(description)
    q = dyn.random_configuration(model, 3)
    return dyn.rnea(model, dyn.Data(model), q, np.ones(model.nv), np.ones(model.nv))


def moved(placement):
    return placement @ placement


class Pickles(unittest.TestCase):
    def test_a_description_is_the_same_after_a_pickle(self):
        model = full()
        again = pickle.loads(pickle.dumps(model))
        self.assertEqual(again.to_json(), model.to_json())
        self.assertEqual(len(again.geometries), len(model.geometries))
        self.assertEqual(again.bodies[-2].joint.parameters["parts"][1].name, "slide")
        self.assertEqual(again.constraints[0].baumgarte, (10.0, 1 / 3))
        self.assertEqual(again.notes, model.notes)
        again.bodies[1].inertia.mass = 99
        self.assertNotEqual(again.to_json(), model.to_json())

    def test_other_processes_compute_the_same_bytes(self):
        description = dyn.load(MODELS / "biped.urdf", root="free_flyer")
        placement = dyn.SE3.exp(dyn.Motion([0.1, 0.2, 0.3], [0.4, 0.5, 0.6]))
        for method in ("fork", "spawn"):
            with multiprocessing.get_context(method).Pool(2) as pool:
                for result in pool.map(torques, [description] * 3):
                    np.testing.assert_array_equal(result, torques(description))
                self.assertEqual(pool.map(moved, [placement]), [moved(placement)])

    def test_what_is_no_pickled_model_is_refused(self):
        for wrong in ("{}", "no json", full().to_json()[:-20]):
            with self.assertRaisesRegex(dyn.Error, "a pickled model"):
                dyn.Model.__new__(dyn.Model).__setstate__(wrong)


if __name__ == "__main__":
    unittest.main()
