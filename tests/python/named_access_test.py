# SPDX-License-Identifier: BSD-2-Clause
"""Joints and frames by name, completion, and the warnings and errors that help to write programs."""
import pathlib
import unittest
import warnings

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


class Places(unittest.TestCase):
    def setUp(self):
        self.model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        self.data = dyn.Data(self.model)
        self.joint, self.frame = self.model.joints[3].name, self.model.frames[-1].name
        q = dyn.random_configuration(self.model, 1)
        v, a = np.random.default_rng(1).normal(size=(2, self.model.nv))
        dyn.forward_kinematics(self.model, self.data, q, v, a)

    def test_places_show_what_the_kinematics_found(self):
        model, data = self.model, self.data
        for place, name, functions in (
            (data.joint(self.joint), self.joint, (dyn.joint_placement, dyn.joint_velocity, dyn.joint_acceleration, dyn.get_joint_jacobian)),
            (data.frame(self.frame), self.frame, (dyn.frame_placement, dyn.frame_velocity, dyn.frame_acceleration, dyn.get_frame_jacobian)),
        ):
            self.assertEqual(place.name, name)
            self.assertEqual(place.placement, functions[0](model, data, name))
            self.assertEqual(place.velocity, functions[1](model, data, name))
            self.assertEqual(place.acceleration, functions[2](model, data, name))
            np.testing.assert_array_equal(place.jacobian, functions[3](model, data, name))

    def test_places_keep_their_data_alive_and_follow_it(self):
        place, before = self.data.frame(self.frame), self.data.frame(self.frame).placement
        dyn.forward_kinematics(self.model, self.data, dyn.neutral(self.model))
        self.assertNotEqual(place.placement, before)
        after = place.placement
        del self.data, self.model
        self.assertEqual(place.placement, after)
        with self.assertRaises(dyn.Error):
            place.velocity  # noqa: B018, the last forward_kinematics had no v

    def test_names_are_completed_and_suggested(self):
        data = self.data
        self.assertIn(self.frame, dir(data.frames))
        self.assertIn(self.joint, data.joints)
        self.assertEqual(getattr(data.joints, self.joint).name, self.joint)
        self.assertEqual(data.joints[self.joint].id, 3)
        self.assertEqual(list(data.joints), [j.name for j in self.model.joints])
        self.assertEqual(len(data.frames), len(self.model.frames))
        self.assertEqual(data.model.nv, self.model.nv)
        with self.assertRaisesRegex(dyn.Error, f"did you mean '{self.frame}'"):
            data.frame(self.frame + "x")
        with self.assertRaisesRegex(AttributeError, f"did you mean '{self.joint}'"):
            getattr(data.joints, self.joint + "x")

    def test_slices_of_joints_are_found_by_name(self):
        index = self.model.v_index
        self.assertEqual(index["root_joint"], slice(0, 6, 1))
        self.assertEqual(dict(index)[self.joint], index[self.joint])
        self.assertEqual(sum(s.stop - s.start for _, s in index.items()), self.model.nv)
        self.assertEqual(len(index), len(list(index)))
        self.assertEqual(list(index.values()), [index[name] for name in index.keys()])
        self.assertEqual((index.get(self.joint), index.get("no"), index.get("universe", 1)), (index[self.joint], None, 1))
        self.assertIn(self.joint, index)
        self.assertNotIn("universe", index)
        with self.assertRaisesRegex(dyn.Error, "did you mean 'root_joint'"):
            index["rot_joint"]


class Warnings(unittest.TestCase):
    def light(self):
        model = dyn.Model()
        joint = dyn.JointDescription("wheel", "continuous", {"axis": [0, 0, 1]})
        joint.lower, joint.upper = [-1, -1], [1, 1]
        model.add_body("rim", 0, dyn.JointDescription("axle", "revolute", {"axis": [0, 0, 1]}))
        return model

    def test_warnings_of_the_compiler_are_pythons(self):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model = dyn.compile(self.light())
        self.assertTrue(model.warnings)
        self.assertEqual([str(w.message) for w in caught], model.warnings)
        self.assertTrue(all(issubclass(w.category, dyn.ModelWarning) for w in caught))
        self.assertEqual(caught[0].filename, __file__)

    def test_warnings_can_be_errors(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(dyn.ModelWarning):
                dyn.compile(self.light())


class Versions(unittest.TestCase):
    def test_the_version_says_what_runs(self):
        version = dyn.version()
        self.assertEqual(version.number, dyn.__version__)
        self.assertIn(version.instruction_set, ("avx512", "avx2", "baseline", "scalar"))
        self.assertGreater(version.plugin_interface, 0)


if __name__ == "__main__":
    unittest.main()
