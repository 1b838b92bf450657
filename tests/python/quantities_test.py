# SPDX-License-Identifier: BSD-2-Clause
"""Several quantities at once, frames of many states, layouts of other libraries, and parameters of inertias."""
import pathlib
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


class OfABiped(unittest.TestCase):
    def setUp(self):
        self.model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        self.data = dyn.Data(self.model)
        random = np.random.default_rng(1)
        self.q = np.stack([dyn.random_configuration(self.model, k) for k in range(5)])
        self.v, self.a = random.normal(size=(2, 5, self.model.nv))
        self.frame, self.joint = self.model.frames[-1].name, self.model.joints[-1].name


class Quantities(OfABiped):
    def test_quantities_at_once_are_those_of_their_functions(self):
        model, data, q, v, a = self.model, self.data, self.q[0], self.v[0], self.a[0]
        what = ["rnea", "nle", "gravity", "mass_matrix", "minverse", "coriolis", "joint_jacobians", "centroidal_rate", "energies", "center_of_mass",
                "rnea_derivatives", "accelerations"]
        found = dyn.compute(model, data, what, q, v, a)
        velocity = dyn.frame_velocity(model, data, self.frame)
        self.assertEqual(
            set(found),
            {"tau", "nle", "gravity", "M", "Minv", "C", "J", "hg", "dhg", "Ag", "dAg", "kinetic_energy", "potential_energy", "center_of_mass", "dtau_dq",
             "dtau_dv", "passes"})
        self.assertEqual(found["passes"]["joints"], 1)
        close = dict(rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(found["tau"], dyn.rnea(model, data, q, v, a), **close)
        np.testing.assert_allclose(found["M"], dyn.crba(model, data, q), **close)
        np.testing.assert_allclose(found["Minv"], dyn.compute_minverse(model, data, q), **close)
        np.testing.assert_allclose(found["C"], dyn.compute_coriolis_matrix(model, data, q, v), **close)
        np.testing.assert_allclose(found["dhg"], dyn.compute_centroidal_momentum_time_variation(model, data, q, v, a).dhg, **close)
        np.testing.assert_allclose(found["dtau_dq"], dyn.compute_rnea_derivatives(model, data, q, v, a).dtau_dq, **close)
        self.assertAlmostEqual(found["kinetic_energy"], dyn.compute_kinetic_energy(model, data, q, v), places=9)
        np.testing.assert_allclose(found["center_of_mass"].position, dyn.center_of_mass(model, data, q).position, **close)
        dyn.forward_kinematics(model, data, q, v)
        np.testing.assert_allclose(velocity.vector, dyn.frame_velocity(model, data, self.frame).vector, **close)

    def test_unknown_quantities_and_wrong_sizes_are_named(self):
        with self.assertRaisesRegex(dyn.Error, "no quantity 'mas_matrix'; did you mean 'mass_matrix'"):
            dyn.compute(self.model, self.data, ["mas_matrix"], self.q[0])
        with self.assertRaisesRegex(dyn.Error, "q has 22 entries"):
            dyn.compute(self.model, self.data, ["rnea"], self.q[0][1:])
        self.assertEqual(dyn.compute(self.model, self.data, [], self.q[0])["passes"]["dynamics"], 0)

    def test_derivatives_under_external_forces_agree_with_differences(self):
        model, data, q, v, a = self.model, self.data, self.q[0], self.v[0], self.a[0]
        fext = np.random.default_rng(3).normal(size=(model.njoints, 6))
        by_q = dyn.compute_rnea_derivatives(model, data, q, v, a, fext=fext).dtau_dq
        tau = dyn.rnea(model, data, q, v, a, fext=fext)
        forward = dyn.compute_aba_derivatives(model, data, q, v, tau, fext=fext)
        np.testing.assert_allclose(forward.ddq, a, atol=1e-8)
        np.testing.assert_allclose(forward.ddq_dq, -forward.Minv @ by_q, rtol=1e-6, atol=1e-6)
        h = 1e-6
        for k in range(model.nv):
            step = h * np.eye(model.nv)[k]
            ahead, behind = (dyn.rnea(model, data, dyn.integrate(model, q, s), v, a, fext=fext) for s in (step, -step))
            np.testing.assert_allclose((ahead - behind) / (2 * h), by_q[:, k], atol=1e-4)

    def test_derivatives_of_gravity_and_of_the_centre_of_mass(self):
        model, data, q, v, a = self.model, self.data, self.q[0], self.v[0], self.a[0]
        zero = np.zeros(model.nv)
        expected = dyn.compute_rnea_derivatives(model, data, q, zero, zero).dtau_dq
        np.testing.assert_allclose(dyn.compute_generalized_gravity_derivatives(model, data, q), expected, atol=1e-9)
        vcom_dq, acom_dq, acom_dv = dyn.compute_center_of_mass_derivatives(model, data, q, v, a)
        h = 1e-6
        for k in range(model.nv):
            step = h * np.eye(model.nv)[k]
            ahead, behind = (dyn.center_of_mass(model, data, dyn.integrate(model, q, s), v, a) for s in (step, -step))
            np.testing.assert_allclose((ahead.velocity - behind.velocity) / (2 * h), vcom_dq[:, k], atol=1e-6)
            np.testing.assert_allclose((ahead.acceleration - behind.acceleration) / (2 * h), acom_dq[:, k], atol=1e-5)
            ahead, behind = (dyn.center_of_mass(model, data, q, v + s, a) for s in (step, -step))
            np.testing.assert_allclose((ahead.acceleration - behind.acceleration) / (2 * h), acom_dv[:, k], atol=1e-6)

    def test_jacobians_at_the_present_configuration(self):
        model, data, q = self.model, self.data, self.q[0]
        dyn.forward_kinematics(model, data, q)
        for reference in (dyn.LOCAL, dyn.WORLD, dyn.LOCAL_WORLD_ALIGNED):
            present = dyn.get_frame_jacobian(model, data, self.frame, reference), dyn.get_joint_jacobian(model, data, self.joint, reference)
            np.testing.assert_array_equal(present[0], dyn.compute_frame_jacobian(model, data, q, self.frame, reference))
            np.testing.assert_array_equal(present[1], dyn.compute_joint_jacobian(model, data, q, self.joint, reference))


class ManyStates(OfABiped):
    def test_frames_of_many_states_are_those_of_each(self):
        model = self.model
        for make, tolerance in ((dyn.BatchData, 1e-12), (dyn.BatchDataFloat, 1e-4)):
            batch = make(model, 8, dyn.Need.KINEMATICS | dyn.Need.JACOBIANS, threads=2)
            kind = np.float32 if make is dyn.BatchDataFloat else np.float64
            q, v, a = (x.astype(kind) for x in (self.q, self.v, self.a))
            with self.assertRaises(dyn.Error):
                dyn.frame_placement(model, batch, self.frame)
            dyn.forward_kinematics(model, batch, q, v, a)
            placements = dyn.frame_placement(model, batch, self.frame)
            velocities = dyn.frame_velocity(model, batch, self.frame, dyn.LOCAL_WORLD_ALIGNED)
            accelerations = dyn.frame_acceleration(model, batch, self.frame)
            of_frame = dyn.compute_frame_jacobian(model, batch, q, self.frame)
            of_joint = dyn.compute_joint_jacobian(model, batch, q, self.joint, dyn.WORLD)
            self.assertEqual((placements.shape, velocities.shape, of_frame.shape), ((5, 4, 4), (5, 6), (5, 6, model.nv)))
            self.assertEqual(placements.dtype, kind)
            close = dict(rtol=tolerance, atol=100 * tolerance)
            for k in range(5):
                dyn.forward_kinematics(model, self.data, self.q[k], self.v[k], self.a[k])
                np.testing.assert_allclose(placements[k], dyn.frame_placement(model, self.data, self.frame).homogeneous, **close)
                np.testing.assert_allclose(velocities[k], dyn.frame_velocity(model, self.data, self.frame, dyn.LOCAL_WORLD_ALIGNED).vector, **close)
                np.testing.assert_allclose(accelerations[k], dyn.frame_acceleration(model, self.data, self.frame).vector, **close)
                np.testing.assert_allclose(of_frame[k], dyn.get_frame_jacobian(model, self.data, self.frame), **close)
                np.testing.assert_allclose(of_joint[k], dyn.get_joint_jacobian(model, self.data, self.joint, dyn.WORLD), **close)

    def test_wrong_arguments_are_named(self):
        batch = dyn.BatchData(self.model, 8, dyn.Need.KINEMATICS | dyn.Need.JACOBIANS)
        with self.assertRaisesRegex(TypeError, "forward_kinematics: q must be"):
            dyn.forward_kinematics(self.model, batch, self.q[0])
        with self.assertRaisesRegex(dyn.Error, "a without v"):
            dyn.forward_kinematics(self.model, batch, self.q, None, self.a)
        dyn.forward_kinematics(self.model, batch, self.q)
        with self.assertRaises(dyn.Error):
            dyn.frame_velocity(self.model, batch, self.frame)
        with self.assertRaisesRegex(dyn.Error, "did you mean"):
            dyn.frame_placement(self.model, batch, self.frame + "x")


class Configurations(OfABiped):
    def test_functions_of_many_states_are_those_of_each(self):
        model, rows = self.model, range(5)
        q = dyn.random_configuration(model, 7, states=5)
        v = np.random.default_rng(0).normal(size=(5, model.nv))
        ends = dyn.integrate(model, q, v)
        ways, halfway = dyn.difference(model, q, ends), dyn.interpolate(model, q, ends, 0.5)
        scaled = dyn.normalize(model, 2 * q)
        for k in rows:
            np.testing.assert_array_equal(q[k], dyn.random_configuration(model, 7 + k))
            np.testing.assert_array_equal(ends[k], dyn.integrate(model, q[k], v[k]))
            np.testing.assert_array_equal(ways[k], dyn.difference(model, q[k], ends[k]))
            np.testing.assert_array_equal(halfway[k], dyn.interpolate(model, q[k], ends[k], 0.5))
            np.testing.assert_array_equal(scaled[k], dyn.normalize(model, 2 * q[k]))
        # One state counts for all rows.
        np.testing.assert_array_equal(dyn.integrate(model, q[0], v)[3], dyn.integrate(model, q[0], v[3]))
        path = dyn.interpolate(model, q[0], ends[0], np.linspace(0, 1, 3))
        np.testing.assert_array_equal(path[1], halfway[0])
        self.assertEqual(dyn.random_configuration(model, 7, states=0).shape, (0, model.nq))

    def test_wrong_shapes_are_named(self):
        model, q, v = self.model, self.q, self.v
        with self.assertRaisesRegex(dyn.Error, r"integrate: v has the shape \(3, 22\); it must be \(22,\) or \(5, 22\)"):
            dyn.integrate(model, q, v[:3])
        with self.assertRaisesRegex(dyn.Error, r"difference: q0 has the shape \(5, 22\); it must be \(23,\) or \(states, 23\)"):
            dyn.difference(model, v, q)
        with self.assertRaisesRegex(TypeError, "integrate: q must be an array of numbers, not <class 'str'>"):
            dyn.integrate(model, "q", v)
        batch = dyn.BatchData(model, 4)
        with self.assertRaisesRegex(dyn.Error, r"rnea: q has the shape \(5, 23\); it must be \(1 to 4, 23\), a state a row"):
            dyn.rnea(model, batch, q, v, v)
        with self.assertRaisesRegex(dyn.Error, r"rnea: a has the shape \(2, 22\); it must be \(3, 22\), a state a row"):
            dyn.rnea(model, batch, q[:3], v[:3], v[:2])


class Errors(OfABiped):
    def test_errors_say_the_place_and_the_remedy(self):
        with self.assertRaises(dyn.Error) as caught:
            dyn.integrate(self.model, 0 * self.q[0], self.v[0])
        self.assertEqual((caught.exception.code, caught.exception.place), ("argument", "joint 'root_joint'"))
        self.assertEqual(caught.exception.remedy, "neutral() gives the identity")
        with self.assertRaises(dyn.Error) as caught:
            dyn.load("/nowhere/robot.urdf")
        self.assertEqual((caught.exception.place, caught.exception.remedy), ("/nowhere/robot.urdf", ""))


class Layouts(OfABiped):
    def test_states_go_to_other_layouts_and_back(self):
        for layout in ("pinocchio", "rbdl", "mujoco", "drake"):
            q, v = dyn.to_layout(self.model, layout, self.q[0], self.v[0])
            self.assertEqual(len(q), dyn.layout_nq(self.model, layout))
            back = dyn.from_layout(self.model, layout, q, v)
            np.testing.assert_allclose(dyn.difference(self.model, self.q[0], back[0]), 0, atol=1e-12)
            np.testing.assert_allclose(back[1], self.v[0], atol=1e-12)
        q, _ = dyn.to_layout(self.model, "mujoco", self.q[0], self.v[0])
        np.testing.assert_allclose(q[3:7], self.q[0][[6, 3, 4, 5]])
        with self.assertRaisesRegex(dyn.Error, "layout is 'x'; it must be one of 'pinocchio'"):
            dyn.layout_nq(self.model, "x")


class InertialParameters(unittest.TestCase):
    def test_parameters_describe_the_same_body(self):
        inertia = dyn.Inertia(2.0, [0.1, 0.2, 0.3], np.diag([0.3, 0.4, 0.5]))
        pi = dyn.to_dynamic_parameters(inertia)
        np.testing.assert_allclose(pi[:4], [2.0, 0.2, 0.4, 0.6])
        np.testing.assert_allclose(dyn.inertia_from_dynamic_parameters(pi).matrix, inertia.matrix, atol=1e-14)
        J = dyn.pseudo_inertia(pi)
        np.testing.assert_allclose(J[:, 3], [0.2, 0.4, 0.6, 2.0])
        np.testing.assert_allclose(dyn.dynamic_parameters_of_pseudo_inertia(J), pi, atol=1e-14)
        theta = dyn.log_cholesky(J)
        np.testing.assert_allclose(dyn.pseudo_inertia_from_log_cholesky(theta), J, atol=1e-13)
        self.assertTrue(dyn.physical_consistency(inertia))
        impossible = dyn.physical_consistency(dyn.Inertia(1.0, [0, 0, 0], np.diag([1.0, 1.0, 3.0])))
        self.assertFalse(impossible.consistent)
        self.assertLess(impossible.margin, 0)
        with self.assertRaisesRegex(dyn.Error, "positive definite"):
            dyn.log_cholesky(np.zeros((4, 4)))


if __name__ == "__main__":
    unittest.main()
