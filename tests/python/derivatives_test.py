# SPDX-License-Identifier: BSD-2-Clause
"""Derivatives of kinematics and constrained dynamics, regressors and factors in Python."""
import pathlib
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


class Derivatives(unittest.TestCase):
    def setUp(self):
        self.model = dyn.compile(dyn.load(BIPED, root="free_flyer"), dissipation=False, armature=False)
        self.data = dyn.Data(self.model)
        self.q = dyn.random_configuration(self.model, 3)
        self.v, self.a = np.random.default_rng(3).normal(size=(2, self.model.nv))

    def difference(self, function):
        """Returns the derivative of function(q, v, a) by q, in columns."""
        h = 1e-6
        columns = []
        for step in h * np.eye(self.model.nv):
            ahead = function(dyn.integrate(self.model, self.q, step), self.v, self.a)
            columns.append((ahead - function(dyn.integrate(self.model, self.q, -step), self.v, self.a)) / (2 * h))
        return np.stack(columns, -1)

    def test_velocities_and_accelerations_of_frames(self):
        model, data = self.model, self.data
        frame = model.frames[-1].name

        def acceleration(q, v, a):
            dyn.forward_kinematics(model, data, q, v, a)
            return dyn.frame_acceleration(model, data, frame).vector

        def velocity(q, v, a):
            dyn.forward_kinematics(model, data, q, v)
            return dyn.frame_velocity(model, data, frame).vector

        by_q = self.difference(acceleration)
        dyn.compute_forward_kinematics_derivatives(model, data, self.q, self.v, self.a)
        v_dq, a_dq, a_dv, a_da = dyn.get_frame_acceleration_derivatives(model, data, frame)
        np.testing.assert_allclose(a_dq, by_q, atol=1e-5)
        np.testing.assert_allclose(dyn.get_frame_velocity_derivatives(model, data, frame)[0], v_dq)
        np.testing.assert_allclose(a_da, dyn.compute_frame_jacobian(model, data, self.q, frame), atol=1e-12)
        np.testing.assert_allclose(v_dq, self.difference(velocity), atol=1e-5)

    def test_second_derivatives_of_rnea(self):
        model, data = self.model, self.data
        qq, qv, vv, aq = dyn.compute_rnea_second_order_derivatives(model, data, self.q, self.v, self.a)
        by_q = self.difference(lambda q, v, a: dyn.compute_rnea_derivatives(model, data, q, v, a).dtau_dv)
        np.testing.assert_allclose(np.moveaxis(qv, 0, -1), by_q, atol=1e-4)
        by_q = self.difference(lambda q, v, a: dyn.crba(model, data, q))
        np.testing.assert_allclose(np.moveaxis(aq, 0, -1), by_q, atol=1e-4)
        self.assertEqual((qq.shape, vv.shape), ((model.nv,) * 3,) * 2)

    def test_regressors_are_linear_in_the_parameters(self):
        model, data = self.model, self.data
        pi = dyn.dynamic_parameters(model)
        np.testing.assert_allclose(dyn.compute_joint_torque_regressor(model, data, self.q, self.v, self.a) @ pi,
                                   dyn.rnea(model, data, self.q, self.v, self.a), atol=1e-9)
        self.assertAlmostEqual(dyn.compute_kinetic_energy_regressor(model, data, self.q, self.v) @ pi,
                               dyn.compute_kinetic_energy(model, data, self.q, self.v), places=9)
        self.assertAlmostEqual(dyn.compute_potential_energy_regressor(model, data, self.q) @ pi,
                               dyn.compute_potential_energy(model, data, self.q), places=9)

    def test_factors_of_the_mass_matrix(self):
        model, data = self.model, self.data
        mass = dyn.crba(model, data, self.q)
        dyn.cholesky.decompose(model, data)
        np.testing.assert_allclose(mass @ dyn.cholesky.solve(model, data, self.v), self.v, atol=1e-9)
        np.testing.assert_allclose(dyn.cholesky.Mv(model, data, np.eye(model.nv)), mass, atol=1e-9)
        columns = np.random.default_rng(1).standard_normal((model.nv, 11))
        one_by_one = np.stack([dyn.cholesky.solve(model, data, x) for x in columns.T], axis=1)
        np.testing.assert_allclose(dyn.cholesky.solve(model, data, columns), one_by_one, rtol=1e-9, atol=1e-9)
        self.assertGreater(dyn.condition_of_mass_matrix(model, data), 1)
        tau = dyn.rnea(model, data, self.q, self.v, self.a)
        np.testing.assert_allclose(dyn.forward_dynamics(model, data, self.q, self.v, tau), self.a, atol=1e-8)

    def test_derivatives_of_constrained_dynamics(self):
        model, data = self.model, self.data
        held = dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.frame_contact(model.frames[-1].name)]))
        tau = np.zeros(model.nv)
        derivatives = dyn.compute_constraint_dynamics_derivatives(model, data, self.q, self.v, tau, held)
        for function, derivative in ((lambda m: m.ddq, derivatives[0]), (lambda m: m.forces, derivatives[3])):
            by_q = self.difference(lambda q, v, a: function(dyn.constraint_dynamics(model, data, q, v, tau, held)))
            np.testing.assert_allclose(derivative, by_q, atol=1e-4 * max(1, np.abs(by_q).max()))
        impact = dyn.compute_impulse_dynamics_derivatives(model, data, self.q, self.v, 0.0, held)
        by_q = self.difference(lambda q, v, a: dyn.impulse_dynamics(model, data, q, v, 0.0, held).v_after)
        np.testing.assert_allclose(impact[0], by_q, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
