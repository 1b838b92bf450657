# SPDX-License-Identifier: BSD-2-Clause
"""Descriptions, compiled models and spatial quantities in Python."""
import copy
import os
import pathlib
import pickle
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


def pendulum(length=1.0):
    model = dyn.Model()
    hinge = dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]})
    hinge.damping = 0.1
    hinge.lower, hinge.upper = -3, 3
    model.add_body("rod", 0, hinge, dyn.Inertia(2.0, [0, 0, -length], 0.01 * np.eye(3)))
    model.add_frame("tip", "rod", dyn.SE3.translation(0, 0, -length))
    return model


class Models(unittest.TestCase):
    def test_a_model_built_by_calls_moves_as_described(self):
        model = dyn.compile(pendulum())
        data = dyn.Data(model)
        self.assertEqual((model.nq, model.nv, model.njoints), (1, 1, 2))
        self.assertEqual((model.lower[0], model.upper[0], model.mass), (-3, 3, 2))
        tau = dyn.rnea(model, data, [0.3], [2.0], [1.0])
        self.assertAlmostEqual(tau[0], 2.0 + 0.01 + 0.1 * 2.0 + 2 * 9.81 * np.sin(0.3), places=12)
        dyn.forward_kinematics(model, data, [0.3], [2.0])
        np.testing.assert_allclose(dyn.frame_placement(model, data, "tip").p, [-np.sin(0.3), 0, -np.cos(0.3)], atol=1e-15)
        velocity = dyn.frame_velocity(model, data, "tip", dyn.LOCAL_WORLD_ALIGNED)
        np.testing.assert_allclose(velocity.linear, [-2 * np.cos(0.3), 0, 2 * np.sin(0.3)], atol=1e-15)
        np.testing.assert_allclose(dyn.compute_frame_jacobian(model, data, [0.3], "tip", dyn.LOCAL_WORLD_ALIGNED)[:3, 0], velocity.linear / 2)
        self.assertAlmostEqual(dyn.compute_kinetic_energy(model, data, [0.3], [2.0]), 0.5 * 2.01 * 4)

    def test_cubes_are_volumes(self):
        description = pendulum()
        description.add_geometry("cubes", "rod", dyn.Voxels([[0, 0, -1], [0, 0, -2]], [0.5, 1.0]))
        description.add_geometry("ball", 0, dyn.Sphere(0.25), dyn.SE3.translation(3, 0, -2))
        model = dyn.compile(description)
        volumes = dyn.compile_geometry(model, description)
        data, volume_data = dyn.Data(model), dyn.GeometryData(volumes)
        dyn.update_geometry_placements(model, data, volumes, volume_data, [0.0])
        self.assertAlmostEqual(dyn.compute_minimum_distance(volumes, volume_data).distance, 3 - 0.25 - 0.5, places=6)
        with self.assertRaisesRegex(dyn.Error, "1 centres and 2 sizes"):
            dyn.Voxels([[0, 0, 0]], [1.0, 2.0])

    def test_bodies_of_a_description_are_changed_in_place(self):
        description = pendulum()
        description.bodies[1].inertia.mass = 5
        description.gravity = [0, 0, 0]
        model = dyn.compile(description)
        self.assertEqual(model.mass, 5)
        np.testing.assert_array_equal(model.gravity, np.zeros(3))

    def test_parts_of_a_description_are_found_by_name(self):
        model = pendulum()
        model.joint("hinge").damping = 0.7
        model.body("rod").inertia = dyn.Inertia(3.0, [0, 0, -1], 0.01 * np.eye(3))
        self.assertEqual((model.bodies[1].joint.damping, model.bodies[1].inertia.mass), ([0.7], 3))
        with self.assertRaisesRegex(dyn.Error, "no joint 'hing'; did you mean 'hinge'"):
            model.joint("hing")
        with self.assertRaisesRegex(dyn.Error, "no body 'rood'; did you mean 'rod'"):
            model.body("rood")

    def test_joints_are_found_by_name(self):
        model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        record = model.joints[3]
        self.assertEqual(model.joint(record.name).idx_q, record.idx_q)
        self.assertEqual(model.q_index["root_joint"], slice(0, 7, 1))
        self.assertEqual(model.v_index["root_joint"], slice(0, 6, 1))
        with self.assertRaisesRegex(dyn.Error, "did you mean"):
            model.joint(record.name + "x")

    def test_options_and_errors_of_load(self):
        with self.assertRaisesRegex(dyn.Error, "must be one of 'coupled', 'independent'"):
            dyn.load(BIPED, mimic="no")
        with self.assertRaises(dyn.Error) as caught:
            inertia = "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/>"
            dyn.parse(f"<robot name='x'>\n<link name='a'><inertial><mass value='1,5'/>{inertia}</inertial></link></robot>", "bad.urdf")
        self.assertEqual((caught.exception.code, caught.exception.file, caught.exception.line), ("syntax", "bad.urdf", 2))
        with self.assertRaises(dyn.Error) as caught:
            dyn.load("/no/such.urdf")
        self.assertEqual(caught.exception.code, "file")

    def test_held_joints_and_parts(self):
        description = dyn.load(BIPED, root="free_flyer")
        whole = dyn.compile(description)
        name = whole.joints[-1].name
        self.assertEqual(dyn.compile(description, lock={name: 0.2}).nv, whole.nv - 1)
        self.assertEqual(dyn.compile(dyn.reduce(description, {name: None})).nv, whole.nv - 1)
        self.assertEqual(dyn.compile(dyn.keep_only(description, [name])).nv, 1)
        two = dyn.append(description, pendulum(), whole.frames[-1].name, prefix="p_")
        self.assertEqual(dyn.compile(two).nv, whole.nv + 1)

    def test_options_and_properties_of_compiled_models(self):
        description = dyn.load(BIPED, root="free_flyer")
        model = dyn.compile(description, lane_groups=False, instruction_set="scalar")
        self.assertFalse(any("lane group" in line and "joints" in line for line in model.passes if "no lane" not in line))
        with self.assertRaisesRegex(dyn.Error, "mmx"):
            dyn.compile(description, instruction_set="mmx")
        held = model.joints[-1].name
        self.assertEqual(len(dyn.compile(description, lock={held: None}).held), 1)
        self.assertEqual((model.find_joint(held), model.find_joint("no"), model.find_frame("no")), (model.njoints - 1, -1, -1))
        self.assertEqual((description.find_body("no"), description.find_joint("root_joint")), (-1, 1))
        self.assertFalse(model.follows)
        self.assertGreater(model.nbytes, 1000)
        two = pendulum()
        two.add_body("far", 0, dyn.JointDescription("far_hinge", "revolute", {"axis": [0, 1, 0]}), dyn.Inertia(1.0, [0, 0, -1.0], np.eye(3)))
        self.assertEqual([dyn.compile(two, outputs=["rod"], touching=touching).nv for touching in ([], ["rod", "far"])], [1, 2])

    def test_numbers_change_without_compiling_again(self):
        description = pendulum()
        model = dyn.compile(description)
        numbers = model.numbers()
        self.assertEqual(set(numbers), {"gravity", "inertias", "placements", "damping", "friction", "armature"})
        self.assertEqual((numbers["inertias"]["rod"].mass, numbers["damping"]["hinge"]), (2.0, [0.1]))
        self.assertEqual(model.with_numbers(**numbers).mass, model.mass)
        inertia = dyn.Inertia(3.0, [0, 0, -2.0], np.eye(3))
        changed = model.with_numbers(inertias={"rod": inertia}, damping={"hinge": 0.5}, friction={"hinge": [0.2]}, gravity=[0, 0, -1.62])
        description.bodies[1].inertia = inertia
        description.bodies[1].joint.damping, description.bodies[1].joint.friction = 0.5, 0.2
        description.gravity = [0, 0, -1.62]
        again = dyn.compile(description)
        tau = [dyn.rnea(m, dyn.Data(m), [0.3], [2.0], [1.0])[0] for m in (model, changed, again)]
        self.assertEqual(tau[1], tau[2])
        self.assertNotEqual(tau[0], tau[1])
        longer = model.with_numbers(placements={"hinge": dyn.SE3.translation(0, 0, 1)})
        data = dyn.Data(longer)
        dyn.forward_kinematics(longer, data, [0.0])
        np.testing.assert_array_equal(dyn.frame_placement(longer, data, "tip").p, np.zeros(3))
        with self.assertRaisesRegex(dyn.Error, "no body 'rope'.*rod"):
            model.with_numbers(inertias={"rope": inertia})
        with self.assertRaises(TypeError):
            model.with_numbers(inertias={"rod": 3.0})

    def test_states_of_a_batch_are_of_different_models(self):
        model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        inertias = model.numbers()["inertias"]
        models = []
        for factor in np.linspace(0.5, 2, 7):
            scaled = {name: dyn.Inertia(factor * x.mass, x.com, factor * np.asarray(x.rotational)) for name, x in inertias.items()}
            models.append(model.with_numbers(inertias=scaled))
        q = np.tile(dyn.neutral(model), (7, 1))
        v, a = np.full((7, model.nv), 0.3), np.full((7, model.nv), -0.2)
        batch = dyn.BatchData(model, 7)
        batch.set_models(models)
        tau = dyn.rnea(model, batch, q, v, a)
        for k, m in enumerate(models):
            np.testing.assert_allclose(tau[k], dyn.rnea(m, dyn.Data(m), q[k], v[k], a[k]), rtol=1e-10, atol=1e-10)
        with self.assertRaisesRegex(dyn.Error, "does not come from the batch's own model"):
            batch.set_models([dyn.compile(pendulum())])
        batch.set_models([])

    def test_lists_that_are_copies_cannot_be_changed_by_mistake(self):
        description = pendulum()
        for name in ("constraints", "geometries", "disabled_collisions"):
            self.assertEqual(getattr(description, name), ())
            with self.assertRaises(AttributeError):
                getattr(description, name).append(None)

    def test_all_errors_of_a_file_are_listed(self):
        self.assertEqual(dyn.check(BIPED), [])
        errors = dyn.check("/no/such.urdf")
        self.assertIsInstance(errors[0], dyn.Error)
        self.assertEqual(errors[0].code, "file")

    def test_many_models_come_and_go(self):
        description = pendulum()
        for k in range(3000):
            model = dyn.compile(description)
            dyn.Data(model)
        self.assertEqual(model.nv, 1)

    def test_data_keeps_its_model_alive(self):
        data = dyn.Data(dyn.compile(pendulum()))
        other = dyn.compile(dyn.load(BIPED))
        with self.assertRaises(dyn.Error):
            dyn.rnea(other, data, dyn.neutral(other), np.zeros(other.nv), np.zeros(other.nv))


class Parts(unittest.TestCase):
    def chain(self, count):
        robot = dyn.Model()
        for k in range(count):
            robot.add_body(f"b{k}", k, dyn.JointDescription(f"j{k}", "revolute"), dyn.Inertia(1.0, [0, 0, k], np.eye(3)))
        return robot

    def test_parts_that_a_program_holds_outlive_the_growth_of_the_model(self):
        robot = self.chain(1)
        body = robot.bodies[1]
        joint, inertia, com = body.joint, body.inertia, body.inertia.com
        iterator = iter(robot.bodies)
        next(iterator)
        for k in range(2000):
            robot.add_body(f"more{k}", 0, dyn.JointDescription(f"more_joint{k}", "fixed"))
            robot.add_frame(f"frame{k}", 0)
        self.assertEqual((body.name, joint.name, inertia.mass, list(com), next(iterator).name), ("b0", "j0", 1.0, [0, 0, 0], "b0"))
        robot.bodies[1].inertia.mass = 3
        self.assertEqual(robot.bodies[1].inertia.mass, 3)

    def test_slices_are_parts_and_lists_are_not_changed_but_by_the_model(self):
        robot = self.chain(5)
        for body in robot.bodies[1:3]:
            body.inertia.mass = 9
        self.assertEqual([body.inertia.mass for body in robot.bodies], [0, 9, 9, 1, 1, 1])
        self.assertEqual([body.name for body in robot.bodies[::-2]], ["b4", "b2", "b0"])
        self.assertEqual(robot.bodies[-1].name, "b4")
        with self.assertRaises(IndexError):
            robot.bodies[6]
        with self.assertRaises(TypeError):
            del robot.bodies[1]


class Spatial(unittest.TestCase):
    def test_exponentials_and_logarithms_are_inverses(self):
        w, motion = np.array([0.3, -0.2, 0.5]), dyn.Motion([0.3, -0.2, 0.5], [1, 0.4, -0.7])
        np.testing.assert_allclose(dyn.log3(dyn.exp3(w)), w, atol=1e-15)
        np.testing.assert_allclose(dyn.exp3(w), dyn.SE3.rotation(w).R, atol=1e-15)
        np.testing.assert_allclose(dyn.log6(dyn.exp6(motion)).vector, motion.vector, atol=1e-14)
        np.testing.assert_allclose(dyn.Jlog3(w) @ dyn.Jexp3(w), np.eye(3), atol=1e-14)
        np.testing.assert_allclose(dyn.Jlog6(motion) @ dyn.Jexp6(motion), np.eye(6), atol=1e-13)
        h = 1e-6
        for k in range(3):
            step = h * np.eye(3)[k]
            slope = dyn.log3(dyn.exp3(w).T @ dyn.exp3(w + step)) / h
            np.testing.assert_allclose(slope, dyn.Jexp3(w)[:, k], atol=1e-5)
        for k in range(6):
            ahead = dyn.exp6(dyn.Motion(motion.vector + h * np.eye(6)[k]))
            np.testing.assert_allclose(dyn.log6(dyn.exp6(motion).inverse() @ ahead).vector / h, dyn.Jexp6(motion)[:, k], atol=1e-5)

    def test_quaternions_of_rotations(self):
        R = dyn.exp3([0, 0, np.pi / 2])
        np.testing.assert_allclose(dyn.quaternion_of(R), [0, 0, np.sqrt(0.5), np.sqrt(0.5)], atol=1e-15)
        np.testing.assert_allclose(dyn.rotation_of([0, 0, 3, 3]), R, atol=1e-15)
        for wrong in ([0, 0, 0, 0], [np.nan, 0, 0, 1]):
            with self.assertRaisesRegex(dyn.Error, "quaternion: it is zero or not finite"):
                dyn.rotation_of(wrong)
        with self.assertRaisesRegex(dyn.Error, "R: it is no rotation"):
            dyn.log3(2 * R)

    def test_poses_compose_and_act(self):
        a = dyn.SE3.rotation([0, 0, np.pi / 2])
        b = dyn.SE3.translation(1, 2, 3)
        np.testing.assert_allclose((a @ b).homogeneous, a.homogeneous @ b.homogeneous, atol=1e-15)
        np.testing.assert_allclose(a @ [1, 0, 0], [0, 1, 0], atol=1e-15)
        motion, force = dyn.Motion([1, 2, 3], [4, 5, 6]), dyn.Force([6, 5, 4], [3, 2, 1])
        X = dyn.SE3.exp(dyn.Motion([0.3, -0.2, 0.5], [1, 0.4, -0.7]))
        self.assertAlmostEqual((X @ motion).vector @ (X @ force).vector, motion.vector @ force.vector)
        np.testing.assert_allclose(X.action @ motion.vector, (X @ motion).vector, atol=1e-14)
        np.testing.assert_allclose(X.act_inverse(X @ motion).vector, motion.vector, atol=1e-14)
        np.testing.assert_allclose(dyn.SE3.exp(X.log()).homogeneous, X.homogeneous, atol=1e-15)
        np.testing.assert_allclose((X @ X.inverse()).homogeneous, np.eye(4), atol=1e-15)

    def test_poses_act_on_many_points(self):
        pose = dyn.SE3.translation(0.1, -0.2, 0.3) @ dyn.SE3.rotation([0.4, 0.5, -0.6])
        points = np.random.default_rng(1).normal(size=(3, 3))  # as many points as coordinates: rows are points
        moved = pose @ points
        np.testing.assert_allclose(moved, [pose.R @ p + pose.p for p in points], atol=1e-15)
        np.testing.assert_array_equal(pose.act(points), moved)
        np.testing.assert_allclose(pose.act_inverse(moved), points, atol=1e-15)
        self.assertEqual((pose @ np.empty((0, 3))).shape, (0, 3))
        with self.assertRaises(TypeError):
            pose.act(np.zeros((3, 2)))

    def test_a_rotation_is_given_by_its_vector_or_by_axis_and_angle(self):
        np.testing.assert_allclose(dyn.SE3.rotation([0, 3, 4], 0.5).R, dyn.SE3.rotation([0, 0.3, 0.4]).R, atol=1e-15)
        np.testing.assert_array_equal(dyn.SE3.rotation(vector=[0, 0, 2], angle=0).R, np.eye(3))
        for axis in ([0, 0, 0], [np.inf, 0, 0], [np.nan, 0, 0]):
            with self.assertRaisesRegex(dyn.Error, "axis"):
                dyn.SE3.rotation(axis, 0.5)

    def test_parts_are_views_that_outlive_nothing(self):
        X = dyn.SE3.translation(1, 2, 3)
        p = X.p
        p[0] = 7
        self.assertEqual(X.p[0], 7)
        del X
        np.testing.assert_array_equal(p, [7, 2, 3])

    def test_values_are_copied_compared_pickled_and_printed(self):
        inertia = dyn.Inertia(2.0, [0, 0, 1], np.diag([1.0, 2.0, 2.5]))
        for x in (dyn.SE3.rotation([0.1, 0.2, 0.3]), dyn.Motion([1, 2, 3], [4, 5, 1 / 3]), dyn.Force([1, 2, 3], [4, 5, 1 / 3])):
            # Objects show as many digits as arrays do; with all of them, the text makes the same object.
            with np.printoptions(precision=17):
                text = repr(x)
            for other in (copy.copy(x), copy.deepcopy(x), pickle.loads(pickle.dumps(x)), eval(text, vars(dyn))):
                self.assertEqual(x, other)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(inertia)).matrix, inertia.matrix)
        np.testing.assert_array_equal(eval(repr(inertia), vars(dyn)).matrix, inertia.matrix)

    def test_what_is_no_rotation_or_inertia_is_refused(self):
        with self.assertRaisesRegex(dyn.Error, "not a rotation"):
            dyn.SE3(2 * np.eye(3))
        with self.assertRaisesRegex(dyn.Error, "not a rotation"):
            dyn.SE3(np.diag([1.0, 1.0, -1.0]))
        with self.assertRaisesRegex(dyn.Error, "not symmetric"):
            dyn.Inertia(1.0, [0, 0, 0], np.arange(9.0).reshape(3, 3))


if __name__ == "__main__":
    unittest.main()
