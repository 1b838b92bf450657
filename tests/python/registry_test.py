# SPDX-License-Identifier: BSD-2-Clause
"""Joint types, plugins and the checks of a type in Python."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import libdyn as dyn

EXAMPLES = pathlib.Path(dyn.__file__).parents[2] / "examples"


def plugin():
    """Returns the example plugin with the type 'cam_follower'."""
    (path,) = EXAMPLES.glob("*cam_follower*.so")
    return path


def cam(registry):
    info = registry.joint_type("cam_follower")
    model = dyn.Model()
    cam = dyn.JointDescription("cam", "cam_follower", dyn.example_parameters(info, 1))
    model.add_body("follower", 0, cam, dyn.Inertia(1.0, [0, 0, 0], np.eye(3)))
    return model


class Registry(unittest.TestCase):
    def test_types_say_what_parameters_they_take(self):
        hinge = dyn.registry().joint_type("revolute")
        self.assertEqual((hinge.name, hinge.role, hinge.is_series), ("revolute", "joint", False))
        (axis,) = [p for p in hinge.parameters if p.name == "axis"]
        self.assertEqual(axis.kind, "vector3")
        self.assertTrue(axis.help)
        mimic = dyn.registry().coupling_type("mimic")
        self.assertEqual(mimic.role, "coupling")
        self.assertIn("mimic", [t.name for t in dyn.registry().coupling_types])
        self.assertIn("free_flyer", [t.name for t in dyn.registry().joint_types])
        with self.assertRaisesRegex(dyn.Error, "'hinge' is provided by no plugin; searched:") as caught:
            dyn.registry().joint_type("hinge")
        self.assertEqual(caught.exception.code, "joint_type")

    def test_a_registry_knows_what_it_was_given(self):
        empty = dyn.JointRegistry()
        self.assertEqual((empty.joint_types, empty.plugins, empty.searched), ([], [], []))
        mine = dyn.JointRegistry.standard()
        with self.assertRaisesRegex(dyn.Error, "cam_follower"):
            mine.joint_type("cam_follower")
        mine.load(plugin())
        mine.load(plugin())
        record = mine.plugins[-1]
        self.assertEqual((record.path, record.types, record.problem), (str(plugin()), ["cam_follower"], ""))
        model = dyn.compile(cam(mine), registry=mine)
        self.assertEqual(model.nv, 1)
        with self.assertRaisesRegex(dyn.Error, "'cam_follower' is provided by no plugin"):
            dyn.compile(cam(mine), registry=dyn.JointRegistry.standard())
        self.assertEqual(dyn.compile(dyn.reduce(cam(mine), {"cam": None}, registry=mine)).nv, 0)
        self.assertEqual(dyn.compile(dyn.keep_only(cam(mine), ["cam"], registry=mine), registry=mine).nv, 1)

    def test_a_plugin_loaded_while_the_program_runs_serves_all_calls(self):
        program = """
import sys, libdyn as dyn
robot = dyn.Model()
robot.add_body("rod", 0, dyn.JointDescription("hinge", "revolute", {"axis": [0, 0, 1]}), dyn.Inertia(1.0, [1, 0, 0]))
before = dyn.compile(robot)
assert "cam_follower" not in [t.name for t in dyn.registry().joint_types]
dyn.load_plugin(sys.argv[1])
robot.add_body("follower", 0, dyn.JointDescription("cam", "cam_follower", dyn.example_parameters(dyn.registry().joint_type("cam_follower"), 1)))
assert dyn.compile(robot).nv == 2 and before.nv == 1
assert dyn.rnea(before, dyn.Data(before), [0.0], [0.0], [1.0])[0] == 1.0
"""
        answer = subprocess.run([sys.executable, "-c", program, plugin()], env=dict(os.environ, DYN_PLUGIN_PATH=""), capture_output=True, text=True)
        self.assertEqual(answer.returncode, 0, answer.stderr)

    def test_folders_are_searched_and_failures_recorded(self):
        with tempfile.TemporaryDirectory() as folder:
            broken = pathlib.Path(folder) / "broken.so"
            broken.write_text("no library")
            types = dyn.JointRegistry()
            types.load_directory(folder)
            self.assertEqual(types.searched, [folder])
            self.assertIn("broken.so", types.plugins[0].problem)
            with self.assertRaises(dyn.Error) as caught:
                types.load(broken)
            self.assertEqual(caught.exception.code, "plugin")
        with self.assertRaisesRegex(dyn.Error, "no_such.so"):
            dyn.load_plugin("/no_such.so")

    def test_files_that_others_could_change_need_trust(self):
        with tempfile.TemporaryDirectory() as folder:
            copy = shutil.copy(plugin(), folder)
            os.chmod(copy, 0o777)
            types = dyn.JointRegistry.standard()
            with self.assertRaisesRegex(dyn.Error, "can be written by its group"):
                types.load(copy)
            types.load(copy, trust="any")
            self.assertEqual(types.joint_type("cam_follower").name, "cam_follower")
        with self.assertRaisesRegex(dyn.Error, "trust is 'some'; it must be one of 'owner_only', 'any'"):
            types.load(copy, trust="some")


class Conformance(unittest.TestCase):
    def test_types_pass_their_checks(self):
        for name, parameters in (("revolute", {"axis": [1, 2, 3]}), ("spherical", None)):
            findings = dyn.check_joint_type(name, parameters)
            self.assertGreater(len(findings), 10)
            for finding in findings:
                self.assertTrue(finding.passed, finding)
                self.assertLessEqual(finding.error, finding.bound)
        for finding in dyn.check_coupling_type("mimic", {"coefficients": [1.0, 2.0]}):
            self.assertTrue(finding.passed, finding)

    def test_a_plugin_is_checked_with_the_types_of_its_registry(self):
        types = dyn.JointRegistry.standard()
        types.load(plugin())
        self.assertTrue(all(finding.passed for finding in dyn.check_joint_type("cam_follower", registry=types, seed=2)))
        with self.assertRaisesRegex(dyn.Error, "'cam_follower' is provided by no plugin"):
            dyn.check_joint_type("cam_follower", registry=dyn.JointRegistry.standard())

    def test_parameters_that_the_type_refuses_are_a_finding(self):
        findings = dyn.check_joint_type("revolute", {"axis": [0, 0, 0]})
        self.assertTrue(any(not finding.passed for finding in findings))


if __name__ == "__main__":
    unittest.main()
