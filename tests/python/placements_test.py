# SPDX-License-Identifier: BSD-2-Clause
"""Frames that a program places itself: Jacobians, constraints, external forces in derivatives; and joints that depend on others."""
import pathlib
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"
PLACEMENT = dyn.SE3.translation(0.1, -0.2, 0.3) @ dyn.SE3.rotation([0.4, 0.5, -0.6])


class Placements(unittest.TestCase):
    def setUp(self):
        robot = dyn.load(BIPED, root="free_flyer")
        robot.add_frame("mark", "left_foot", PLACEMENT)
        self.model = dyn.compile(robot)
        self.data = dyn.Data(self.model)
        self.q = dyn.random_configuration(self.model, 4)
        self.v, self.a = np.random.default_rng(4).normal(size=(2, self.model.nv))
        self.joint = self.model.frame("mark").joint
        self.placement = self.model.frame("mark").placement

    def test_the_jacobian_at_a_placement_is_that_of_the_frame_there(self):
        for reference in (dyn.LOCAL, dyn.WORLD, dyn.LOCAL_WORLD_ALIGNED):
            expected = dyn.compute_frame_jacobian(self.model, self.data, self.q, "mark", reference)
            J = dyn.compute_jacobian_at(self.model, self.data, self.q, self.joint, self.placement, reference)
            np.testing.assert_allclose(J, expected, atol=1e-13)

    def test_a_constraint_at_a_placement_is_that_of_the_frame_there(self):
        tau = np.zeros(self.model.nv)

        def motion(constraint, v):
            constraints = dyn.ConstraintData(dyn.ConstraintSet(self.model, [constraint]))
            return dyn.constraint_dynamics(self.model, self.data, self.q, v, tau, constraints)

        for free, by_name in (([False] * 6, dyn.frame_contact("mark")), ([False] * 3 + [True] * 3, dyn.point_contact("mark"))):
            expected = motion(by_name, self.v)
            found = motion(dyn.frame_constraint("mine", "left_foot", placement=PLACEMENT, free=free), self.v)
            np.testing.assert_allclose(found.ddq, expected.ddq, atol=1e-10)
            np.testing.assert_allclose(found.forces, expected.forces, atol=1e-9)
            # At rest the axes do not turn, so only the axes of the forces differ.
            expected = motion(by_name, tau)
            aligned = motion(dyn.frame_constraint("mine", "left_foot", placement=PLACEMENT, free=free, axes=dyn.LOCAL_WORLD_ALIGNED), tau)
            dyn.forward_kinematics(self.model, self.data, self.q)
            R = dyn.frame_placement(self.model, self.data, "mark").R
            np.testing.assert_allclose(aligned.forces[:3], R @ expected.forces[:3], atol=1e-9)
        with self.assertRaisesRegex(dyn.Error, "axes must be"):
            dyn.frame_constraint("mine", "left_foot", axes=dyn.WORLD)

    def test_derivatives_with_external_forces_agree_with_differences(self):
        model, data, q, v, a, h = self.model, self.data, self.q, self.v, self.a, 1e-6
        fext = np.random.default_rng(6).normal(size=(model.njoints, 6))
        tau = dyn.rnea(model, data, q, v, a, fext=fext)
        inverse = dyn.compute_rnea_derivatives(model, data, q, v, a, fext=fext).dtau_dq
        forward = dyn.compute_aba_derivatives(model, data, q, v, tau, fext=fext)
        np.testing.assert_allclose(forward.ddq, a, atol=1e-9)
        for k in range(model.nv):
            ahead, behind = (dyn.integrate(model, q, s * h * np.eye(model.nv)[k]) for s in (1, -1))
            slope = (dyn.rnea(model, data, ahead, v, a, fext=fext) - dyn.rnea(model, data, behind, v, a, fext=fext)) / (2 * h)
            np.testing.assert_allclose(slope, inverse[:, k], atol=1e-5)
            slope = (dyn.aba(model, data, ahead, v, tau, fext=fext) - dyn.aba(model, data, behind, v, tau, fext=fext)) / (2 * h)
            np.testing.assert_allclose(slope, forward.ddq_dq[:, k], atol=1e-4 * np.abs(forward.ddq_dq).max())
        with self.assertRaisesRegex(TypeError, "six columns"):
            dyn.compute_rnea_derivatives(model, data, q, v, a, fext=np.zeros((model.njoints, 5)))

    def test_a_joint_tells_on_which_other_it_depends(self):
        joint = dyn.JointDescription("finger", "revolute", {"axis": [0, 0, 1]})
        self.assertIsNone(joint.coupling)
        joint.couple("thumb", parameters={"coefficients": [0.1, 2.0]})
        self.assertEqual(joint.coupling, ("mimic", "thumb", {"coefficients": [0.1, 2.0]}))


if __name__ == "__main__":
    unittest.main()
