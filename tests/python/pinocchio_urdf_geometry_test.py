# SPDX-License-Identifier: BSD-2-Clause
"""Volumes of URDF files, SRDF files and visualizers under the names of Pinocchio."""
import pathlib
import tempfile
import unittest

import numpy as np

import libdyn as dyn
import libdyn.pinocchio as pin

ARM = pathlib.Path(__file__).parents[2] / "models" / "arm.urdf"

ROBOT = """<robot name="r">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <link name="base">
    <visual><geometry><box size="1 2 3"/></geometry><material name="red"/></visual>
    <collision><origin xyz="0 0 1" rpy="0 0 1.5707963267948966"/><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
    <collision name="soft"><geometry><cylinder radius="0.1" length="0.4"/></geometry></collision>
    <collision_checking><capsule name="soft"/></collision_checking>
  </link>
  <link name="tool">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="package://robot/tool.stl" scale="2 2 2"/></geometry></visual>
    <collision><origin xyz="0.5 0 0"/><geometry><sphere radius="0.2"/></geometry></collision>
  </link>
  <link name="tip">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.3"/></geometry></collision>
  </link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="tool"/><origin xyz="0 0 2"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="flange" type="fixed"><parent link="tool"/><child link="tip"/><origin xyz="0 0 0.7"/></joint>
  <joint name="wheel" type="continuous"><parent link="tip"/><child link="rim"/><axis xyz="1 0 0"/></joint>
  <link name="rim"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""

SRDF = """<robot name="r">
  <disable_collisions link1="tool" link2="base" reason="never"/>
  <group_state name="up" group="all"><joint name="lift" value="0.5"/><joint name="wheel" value="1.5"/><joint name="absent" value="1"/></group_state>
  <rotor_params><joint name="lift" mass="0.01" gear_ratio="10"/></rotor_params>
</robot>"""


class Urdf(unittest.TestCase):
    def setUp(self):
        self.model = pin.buildModelFromXML(ROBOT)

    def test_volumes_lie_where_their_links_are(self):
        volumes = pin.buildGeomFromUrdfString(self.model, ROBOT, pin.COLLISION)
        self.assertEqual([x.name for x in volumes.geometryObjects], ["base_0", "base_1", "tool_0", "tip_0"])
        self.assertEqual([x.meshPath for x in volumes.geometryObjects], ["CYLINDER", "CAPSULE", "SPHERE", "SPHERE"])
        self.assertEqual([x.parentJoint for x in volumes.geometryObjects], [0, 0, 1, 1])
        self.assertEqual([self.model.frames[x.parentFrame].name for x in volumes.geometryObjects], ["base", "base", "tool", "tip"])
        np.testing.assert_allclose(volumes.geometryObjects[0].placement.rotation, pin.rpy.rotate("z", np.pi / 2), atol=1e-15)
        data, placed = self.model.createData(), volumes.createData()
        q = pin.neutral(self.model)
        q[0] = 0.25
        pin.updateGeometryPlacements(self.model, data, volumes, placed, q)
        np.testing.assert_allclose(placed.oMg[2].translation, [0.5, 0, 2.25])
        np.testing.assert_allclose(placed.oMg[3].translation, [0, 0, 2.95])

    def test_meshes_are_found_in_package_folders(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder) / "robot" / "tool.stl"
            mesh.parent.mkdir()
            facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
            mesh.write_text(f"solid s\n{facet}endsolid s\n")
            for given in (folder, [folder], pathlib.Path(folder), [pathlib.Path("/absent"), pathlib.Path(folder)]):
                visuals = pin.buildGeomFromUrdfString(self.model, ROBOT, pin.GeometryType.VISUAL, package_dirs=given)
            self.assertEqual([x.name for x in visuals.geometryObjects], ["base_0", "tool_0"])
            self.assertEqual(visuals.geometryObjects[1].meshPath, str(mesh))
            np.testing.assert_array_equal(visuals.geometryObjects[1].meshScale, [2, 2, 2])
            np.testing.assert_array_equal(visuals.geometryObjects[0].meshColor, [1, 0, 0, 1])
            self.assertTrue(visuals.geometryObjects[0].overrideMaterial)
            visuals.addCollisionPair(pin.CollisionPair(0, 1))
            data = visuals.createData()
            data.oMg[1] = pin.SE3(np.eye(3), np.array([1.5, 0, 0]))
            self.assertAlmostEqual(pin.computeDistance(visuals, data, 0).min_distance, 1.0)
        with self.assertRaisesRegex(ValueError, "package://robot/tool.stl"):
            pin.buildGeomFromUrdfString(self.model, ROBOT, pin.GeometryType.VISUAL)

    def test_distances_are_those_of_libdyn(self):
        model, volumes = pin.buildModelsFromUrdf(ARM, geometry_types=pin.COLLISION)
        volumes.addAllCollisionPairs()
        data, placed = pin.createDatas(model, volumes)
        robot = dyn.load(ARM)
        compact = dyn.compile(robot)
        own = dyn.compile_geometry(compact, robot, all_pairs=False, add=[(a, b) for a in names(volumes) for b in names(volumes) if a < b])
        own_data, own_placed = dyn.Data(compact), dyn.GeometryData(own)
        for seed in range(5):
            q = dyn.random_configuration(compact, seed)
            nearest = pin.computeDistances(model, data, volumes, placed, q)
            dyn.update_geometry_placements(compact, own_data, own, own_placed, q)
            self.assertAlmostEqual(
                min(r.min_distance for r in placed.distanceResults if r.min_distance < np.inf), placed.distanceResults[nearest].min_distance
            )
            for pair, result in zip(volumes.collisionPairs, placed.distanceResults):
                wanted = sorted((volumes.geometryObjects[pair.first].name, volumes.geometryObjects[pair.second].name))
                index = next(k for k, p in enumerate(own.pairs) if sorted(own.names[i] for i in p) == wanted)
                self.assertAlmostEqual(result.min_distance, dyn.compute_distance(own, own_placed, index).distance, places=9)

    def test_malformed_files_are_refused(self):
        for text, message in (
            ("<robot>", "no XML"),
            ("<!DOCTYPE x><robot/>", "document type"),
            (ROBOT.replace('radius="0.2"', 'radius="x"'), "radius"),
            (ROBOT.replace('<sphere radius="0.2"/>', "<star/>"), "star"),
            (ROBOT.replace('"tool"', '"other"'), "other"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                pin.buildGeomFromUrdfString(self.model, text, pin.COLLISION)
        with self.assertRaisesRegex(ValueError, "absent.urdf"):
            pin.buildGeomFromUrdf(self.model, "absent.urdf", pin.COLLISION)


def names(volumes):
    return [x.name for x in volumes.geometryObjects]


class Srdf(unittest.TestCase):
    def setUp(self):
        self.model = pin.buildModelFromXML(ROBOT)

    def test_disabled_pairs_are_removed(self):
        volumes = pin.buildGeomFromUrdfString(self.model, ROBOT, pin.COLLISION)
        volumes.addAllCollisionPairs()
        before = len(volumes.collisionPairs)
        pin.removeCollisionPairsFromXML(self.model, volumes, SRDF)
        self.assertEqual(before - len(volumes.collisionPairs), 2)
        left = {(p.first, p.second) for p in volumes.collisionPairs}
        self.assertEqual(left, {(0, 3), (1, 3)})

    def test_configurations_and_rotors_are_read(self):
        pin.loadReferenceConfigurationsFromXML(self.model, SRDF)
        np.testing.assert_allclose(self.model.referenceConfigurations["up"], [0.5, np.cos(1.5), np.sin(1.5)])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "r.srdf"
            path.write_text(SRDF)
            self.assertTrue(pin.loadRotorParameters(self.model, path))
            with self.assertRaisesRegex(ValueError, "no .srdf file"):
                pin.loadReferenceConfigurations(self.model, folder)
        self.assertEqual((self.model.rotorInertia[0], self.model.rotorGearRatio[0]), (0.01, 10))
        self.assertAlmostEqual(self.model.armature[0], 1.0)
        with self.assertRaisesRegex(ValueError, "lift"):
            pin.loadReferenceConfigurationsFromXML(self.model, SRDF.replace('"0.5"', '"0.5 1"'))


class Others(unittest.TestCase):
    def test_sample_models_have_volumes(self):
        for model, volumes, count in (
            (pin.buildSampleModelManipulator(), pin.buildSampleGeometryModelManipulator, 6),
            (pin.buildSampleModelHumanoid(), pin.buildSampleGeometryModelHumanoid, 27),
        ):
            self.assertEqual(volumes(model).ngeoms, count)
        with self.assertRaisesRegex(ValueError, "rleg_shoulder1_body"):
            pin.buildSampleGeometryModelHumanoid(pin.Model())

    def test_viewers_are_absent_and_can_be_derived(self):
        from libdyn.pinocchio.visualize import BaseVisualizer, MeshcatVisualizer

        model = pin.buildSampleModelManipulator()
        for error in (NotImplementedError, ImportError):
            with self.assertRaisesRegex(error, "BaseVisualizer"):
                MeshcatVisualizer(model).initViewer()

        class Recorder(BaseVisualizer):
            def display(self, q=None):
                shown.append(q)

        shown = []
        viewer = Recorder(model, None, pin.buildSampleGeometryModelManipulator(model))
        viewer.play([1, 2])
        self.assertEqual(shown, [1, 2])
        self.assertEqual(len(viewer.visual_data.oMg), 6)
        with self.assertRaisesRegex(NotImplementedError, "captureImage"):
            viewer.play([1], capture=True)
        for name in ("buildModelsFromSdf", "buildModelsFromMJCF"):
            with self.assertRaises(NotImplementedError):
                getattr(pin, name)("x")

    def test_models_are_written_and_read(self):
        model, other = pin.buildSampleModelHumanoidRandom(), pin.Model()
        other.loadFromString(model.saveToString())
        self.assertEqual(other, model)


if __name__ == "__main__":
    unittest.main()
