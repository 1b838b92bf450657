# SPDX-License-Identifier: BSD-2-Clause
"""Groups and named states, models as URDF, and differences of models in Python."""
import pathlib
import pickle
import tempfile
import unittest

import numpy as np

import libdyn as dyn

ARM = pathlib.Path(__file__).parents[2] / "models" / "arm.urdf"
SRDF = """<robot name="arm">
  <group name="upper"><joint name="shoulder1"/><joint name="shoulder2"/></group>
  <group name="all"><group name="upper"/><chain base_link="upper_arm" tip_link="hand"/></group>
  <group_state name="home" group="upper"><joint name="shoulder2" value="0.5"/></group_state>
  <end_effector name="tool" group="all" parent_link="hand"/>
  <passive_joint name="roll"/>
</robot>"""


class Groups(unittest.TestCase):
    def setUp(self):
        self.robot = dyn.load(ARM)
        dyn.srdf.parse(SRDF, "arm.srdf", self.robot)

    def test_an_srdf_names_groups_and_states(self):
        self.assertEqual(self.robot.joints_of("all"), ["shoulder1", "shoulder2", "roll", "bend", "wrist1", "wrist2"])
        self.assertEqual([group.name for group in self.robot.groups], ["upper", "all"])
        self.assertEqual(self.robot.groups[1].chains[0].tip, "hand")
        self.assertEqual(self.robot.end_effectors[0].body, "hand")
        self.assertEqual(self.robot.passive_joints, ("roll",))
        model = dyn.compile(self.robot)
        q = dyn.named_configuration(model, self.robot, "upper/home")
        self.assertEqual(q[model.joints[model.joint_id("shoulder2")].idx_q], 0.5)
        self.assertEqual(np.count_nonzero(q), 1)
        with self.assertRaisesRegex(dyn.Error, "did you mean 'home'"):
            dyn.named_configuration(model, self.robot, "hme")
        with self.assertRaisesRegex(dyn.Error, "did you mean 'upper'"):
            self.robot.joints_of("uper")

    def test_a_program_adds_groups_and_states(self):
        swing = dyn.ConfigurationDescription("swing", [dyn.JointState("bend", [0.25], [2.0])])
        self.robot.configurations = [*self.robot.configurations, swing]
        self.robot.groups = [dyn.GroupDescription("elbow", joints=["bend"], chains=[dyn.Chain("forearm", "hand")])]
        self.assertEqual(self.robot.joints_of("elbow"), ["bend", "wrist1", "wrist2"])
        model = dyn.compile(self.robot)
        self.assertEqual(np.sum(dyn.named_velocity(model, self.robot, "swing")), 2.0)
        self.assertEqual(np.sum(dyn.named_configuration(model, self.robot, "swing")), 0.25)
        copy = pickle.loads(pickle.dumps(self.robot))
        self.assertEqual(copy.configurations[1].joints[0].v, [2.0])
        self.assertEqual(dyn.differences(self.robot, copy, 0.0), [])


class Urdf(unittest.TestCase):
    def test_a_model_is_written_and_read(self):
        robot = dyn.load(ARM)
        text, lost = dyn.write_urdf(robot)
        self.assertEqual(lost, [])
        self.assertEqual(dyn.differences(robot, dyn.parse(text), 1e-14), [])
        robot.groups = [dyn.GroupDescription("all")]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "arm.urdf"
            self.assertEqual(dyn.save_urdf(robot, path), ["groups (an SRDF has them) of 'all'"])
            (difference,) = dyn.differences(robot, dyn.load(path))
        self.assertEqual((difference.topic, difference.name, difference.a, difference.b), ("group", "all", "present", "-"))

    def test_a_model_is_written_as_mjcf_and_read(self):
        robot = dyn.load(pathlib.Path(ARM).with_suffix(".xml"))
        self.assertEqual(dyn.write_mjcf(robot)[1], [])
        robot.groups = [dyn.GroupDescription("all")]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "arm.xml"
            self.assertEqual(dyn.save_mjcf(robot, path), ["groups (an SRDF has them) of 'all'"])
            self.assertEqual(path.read_text(), dyn.write_mjcf(robot)[0])
            (difference,) = dyn.differences(robot, dyn.load(path))
        self.assertEqual((difference.topic, difference.name), ("group", "all"))

    def test_newer_versions_are_refused_unless_asked(self):
        text = '<robot name="r" version="1.3"><link name="a"/></robot>'
        with self.assertRaisesRegex(dyn.Error, "1.0 to 1.2"):
            dyn.parse(text)
        self.assertEqual(len(dyn.parse(text, versions="any").notes), 1)

    def test_limits_for_planners_are_kept(self):
        robot = dyn.load(ARM)
        robot.bodies[2].joint.jerk_limit = 5
        robot.bodies[2].joint.acceleration_limit = 3
        again = dyn.parse(dyn.write_urdf(robot)[0])
        self.assertEqual((again.bodies[2].joint.jerk_limit, again.bodies[2].joint.acceleration_limit), ([5], [3]))


if __name__ == "__main__":
    unittest.main()
