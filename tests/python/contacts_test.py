# SPDX-License-Identifier: BSD-2-Clause
"""Friction cones, contact steps, Delassus matrices and projections onto constraints, compared with closed forms."""
import unittest

import numpy as np

import libdyn as dyn


def box(gravity=(0, 0, -9.81)):
    """Returns a box of 2 kg that stands on its four lower corners."""
    model = dyn.Model()
    model.gravity = gravity
    model.add_body("box", 0, dyn.JointDescription("box_joint", "free_flyer"), dyn.Inertia(2.0, [0, 0, 0], 2 * 0.02 / 3 * np.eye(3)))
    return dyn.compile(model)


def corners():
    return [dyn.friction_contact(f"corner{k}", "box", [0.1 if k < 2 else -0.1, 0.1 if k % 2 else -0.1, -0.1], [0, 0, 1]) for k in range(4)]


def pendulum():
    model = dyn.Model()
    model.add_body("rod", 0, dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]}), dyn.Inertia(2.0, [0, 0, -1.0], 0.01 * np.eye(3)))
    model.add_frame("tip", "rod", dyn.SE3.translation(0, 0, -1))
    return dyn.compile(model)


def two_rods():
    """Returns two rods side by side, which a third one can connect."""
    model = dyn.Model()
    for name, x in (("left", 0.0), ("right", 1.0)):
        joint = dyn.JointDescription(name + "_hinge", "revolute", {"axis": [0, 1, 0]}, dyn.SE3.translation(x, 0, 0))
        model.add_body(name, 0, joint, dyn.Inertia(1.0, [0, 0, -0.5], 0.02 * np.eye(3)))
    return model


class Batches(unittest.TestCase):
    def test_many_states_give_what_single_states_give(self):
        model = box()
        contacts = dyn.ConstraintSet(model, [dyn.point_contact("box")])
        batch, data, one = dyn.BatchData(model, 6, threads=2), dyn.Data(model), dyn.ConstraintData(contacts)
        many = dyn.BatchConstraintData(contacts, batch)
        self.assertEqual(many.set.rows, 3)
        self.assertGreater(many.nbytes, 0)
        random = np.random.default_rng(1)
        q, v, tau = dyn.random_configuration(model, seed=1, states=5), random.standard_normal((5, 6)), random.standard_normal((5, 6))
        moved = dyn.constraint_dynamics(model, batch, q, v, tau, many)
        after = dyn.impulse_dynamics(model, batch, q, v, 0.25, many)
        self.assertEqual((moved.ddq.shape, moved.forces.shape, after.impulses.shape), ((5, 6), (5, 3), (5, 3)))
        for k in range(5):
            wanted = dyn.constraint_dynamics(model, data, q[k], v[k], tau[k], one)
            np.testing.assert_allclose(moved.ddq[k], wanted.ddq, atol=1e-11)
            np.testing.assert_allclose(moved.forces[k], wanted.forces, atol=1e-11)
            self.assertEqual((moved.rank[k], moved.iterations[k]), (wanted.rank, wanted.iterations))
            self.assertLess(moved.residual[k], 1e-10)
            np.testing.assert_allclose(after.v_after[k], dyn.impulse_dynamics(model, data, q[k], v[k], 0.25, one).v_after, atol=1e-12)
        many.settings.mu = 1e-2
        self.assertGreater(dyn.constraint_dynamics(model, batch, q, v, tau, many).iterations.max(), 1)
        with self.assertRaisesRegex(dyn.Error, "tau is 6 x 4"):
            dyn.constraint_dynamics(model, batch, q, v, tau[:4], many)
        with self.assertRaisesRegex(dyn.Error, "another model"):
            dyn.BatchConstraintData(contacts, dyn.BatchData(box(), 6))


class Friction(unittest.TestCase):
    def test_a_box_on_a_slope_slides_with_what_friction_leaves(self):
        angle, dt = 0.4, 1e-2
        model = box((9.81 * np.sin(angle), 0, -9.81 * np.cos(angle)))
        data, forces = dyn.Data(model), dyn.ConstraintData(dyn.ConstraintSet(model, corners()))
        for friction in (0.0, 0.2, 0.6):
            cones = [dyn.FrictionCone(k, friction) for k in range(4)]
            step = dyn.contact_step(model, data, dyn.neutral(model), np.zeros(6), np.zeros(6), dt, forces, cones)
            self.assertTrue(step.converged)
            sliding = max(0.0, 9.81 * (np.sin(angle) - friction * np.cos(angle)))
            np.testing.assert_allclose(step.v_after, [sliding * dt, 0, 0, 0, 0, 0], atol=1e-8)
            impulses = step.impulse.reshape(4, 3)
            self.assertAlmostEqual(impulses[:, 2].sum(), 2 * 9.81 * np.cos(angle) * dt, places=7)
            self.assertTrue(np.all(np.hypot(impulses[:, 0], impulses[:, 1]) <= friction * impulses[:, 2] * (1 + 1e-14)))
            self.assertLess(step.residual.penetration, 1e-8)
            self.assertLess(step.residual.complementarity, 1e-8)
            self.assertEqual(step.velocity.shape, (12,))

    def test_forces_explain_the_acceleration_of_a_box_at_rest(self):
        model = box()
        data, forces = dyn.Data(model), dyn.ConstraintData(dyn.ConstraintSet(model, corners()))
        rest = np.zeros(6)
        found = dyn.contact_forces(model, data, dyn.neutral(model), rest, rest, rest, forces, [dyn.FrictionCone(k, 0.5) for k in range(4)])
        self.assertTrue(found.converged)
        self.assertAlmostEqual(found.forces.reshape(4, 3)[:, 2].sum(), 2 * 9.81, places=6)
        np.testing.assert_allclose(found.left, 0, atol=1e-6)

    def test_limits_and_joint_friction_are_cones_of_locks(self):
        model = pendulum()
        data, forces = dyn.Data(model), dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.lock_joint("hinge")]))
        limit = dyn.FrictionCone(0, gap=0.0, downwards=True)
        self.assertAlmostEqual(dyn.contact_step(model, data, [0.5], [1.0], [0.0], 1e-3, forces, [limit]).v_after[0], 0.0, places=14)
        away = dyn.contact_step(model, data, [0.5], [-1.0], [0.0], 1e-3, forces, [limit])
        self.assertLess(away.v_after[0], -1.0)
        self.assertEqual(away.impulse[0], 0.0)
        bounce = dyn.contact_step(model, data, [0.5], [1.0], [0.0], 1e-3, forces, [limit], restitution=0.5)
        self.assertAlmostEqual(bounce.v_after[0], -0.5, places=9)
        brake = dyn.FrictionCone(0, 0.3, both_ways=True)
        slowed = dyn.contact_step(model, data, [0.0], [1.0], [0.0], 1e-2, forces, [brake])
        self.assertAlmostEqual(slowed.v_after[0], 1.0 - 0.3 * 1e-2 / 2.01, places=9)

    def test_cones_that_fit_no_constraint_are_refused(self):
        model = box()
        data, forces = dyn.Data(model), dyn.ConstraintData(dyn.ConstraintSet(model, corners()))
        arguments = (model, data, dyn.neutral(model), np.zeros(6), np.zeros(6))
        for cone, message in ((dyn.FrictionCone(4, 0.5), "of constraint 4"), (dyn.FrictionCone(0, -1.0), "friction is negative")):
            with self.assertRaisesRegex(dyn.Error, message):
                dyn.contact_step(*arguments, 1e-3, forces, [cone])
        with self.assertRaisesRegex(dyn.Error, "step of time must be positive"):
            dyn.contact_step(*arguments, 0.0, forces, [])
        with self.assertRaisesRegex(dyn.Error, "restitution must be between 0 and 1"):
            dyn.contact_step(*arguments, 1e-3, forces, [], restitution=2)
        with self.assertRaisesRegex(dyn.Error, "normal has no direction"):
            dyn.friction_contact("c", "box", [0, 0, 0], [0, 0, 0])
        with self.assertRaises(TypeError):
            dyn.contact_step(*arguments, 1e-3, forces, [0])


class Delassus(unittest.TestCase):
    def test_the_matrix_the_operator_and_the_inertia_agree(self):
        model = box()
        data, q = dyn.Data(model), dyn.neutral(model)
        forces = dyn.ConstraintData(dyn.ConstraintSet(model, corners()[:1]))
        matrix = dyn.compute_delassus_matrix(model, data, q, forces)
        jacobian = dyn.compute_constraint_jacobian(model, data, q, forces)
        np.testing.assert_allclose(matrix, jacobian @ dyn.compute_minverse(model, data, q) @ jacobian.T, atol=1e-12)
        inertia = dyn.compute_operational_space_inertia(model, data, q, forces)
        np.testing.assert_allclose(inertia @ matrix, np.eye(3), atol=1e-12)
        operator = dyn.DelassusOperator(model, data, q, forces)
        del model, data, forces
        np.testing.assert_allclose(operator @ [1.0, 2.0, 3.0], matrix @ [1.0, 2.0, 3.0], atol=1e-12)
        np.testing.assert_array_equal(operator.apply([1.0, 2.0, 3.0]), operator @ [1.0, 2.0, 3.0])
        with self.assertRaisesRegex(dyn.Error, "2 entries"):
            operator @ [1.0, 2.0]


class Assembly(unittest.TestCase):
    def test_a_loop_is_closed_from_a_guess(self):
        description = two_rods()
        description.add_frame("left_tip", "left", dyn.SE3.translation(0.5, 0, -1))
        description.add_frame("right_tip", "right", dyn.SE3.translation(-0.5, 0, -1))
        model = dyn.compile(description)
        data = dyn.Data(model)
        loop = dyn.close_loop("loop", "left_tip", "right_tip", [False, True, True, True, True, True])
        closed = dyn.ConstraintData(dyn.ConstraintSet(model, [loop]))
        assembly = dyn.project_configuration(model, data, [0.3, 0.1], closed)
        self.assertTrue(assembly.closed)
        self.assertLess(assembly.error, 1e-10)
        np.testing.assert_array_equal(dyn.assemble(model, data, [0.3, 0.1], closed), assembly.q)
        self.assertFalse(dyn.project_configuration(model, data, [0.3, 0.1], closed, max_iterations=1).closed)
        velocity = dyn.project_velocity(model, data, assembly.q, [1.0, 0.0], closed)
        jacobian = dyn.compute_constraint_jacobian(model, data, assembly.q, closed)
        np.testing.assert_allclose(jacobian @ velocity, 0, atol=1e-12)

    def test_a_loop_that_cannot_close_is_an_error_that_names_it(self):
        description = two_rods()
        description.add_frame("far", "right", dyn.SE3.translation(50, 0, 0))
        model = dyn.compile(description)
        closed = dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.close_loop("loop", "left", "far", [False, True, False, True, True, True])]))
        with self.assertRaisesRegex(dyn.Error, "loop") as caught:
            dyn.assemble(model, dyn.Data(model), [0.0, 0.0], closed)
        self.assertEqual(caught.exception.code, "closure")


class Constraints(unittest.TestCase):
    def test_sets_are_extended_and_describe_their_constraints(self):
        model = dyn.compile(two_rods())
        first = dyn.ConstraintSet(model, [dyn.lock_joint("left_hinge")])
        both = dyn.ConstraintSet(first, [dyn.couple_joint("right_hinge", "left_hinge", parameters={"coefficients": [0.0, 2.0]})])
        self.assertEqual(both.names, ["left_hinge", "right_hinge"])
        self.assertEqual([both.description(k).kind for k in range(2)], ["lock", "coupling"])
        self.assertEqual(both.model.nv, 2)
        with self.assertRaisesRegex(dyn.Error, "constraint"):
            both.description(2)
        data, forces = dyn.Data(model), dyn.ConstraintData(both)
        np.testing.assert_allclose(dyn.constraint_dynamics(model, data, [0.1, 0.2], [0, 0], [0, 0], forces).ddq, 0, atol=1e-12)

    def test_methods_and_external_forces_agree(self):
        model = pendulum()
        data, forces = dyn.Data(model), dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.lock_joint("hinge")]))
        self.assertGreater(forces.nbytes, 0)
        forces.settings.mu = 1e-6
        self.assertEqual(forces.settings.mu, 1e-6)
        fext = np.zeros((2, 6))
        fext[1, 4] = 3.0
        free = dyn.constraint_dynamics(model, data, [0.5], [0.0], [0.0], forces)
        for method in ("articulated", "kkt"):
            pushed = dyn.constraint_dynamics(model, data, [0.5], [0.0], [0.0], forces, fext=fext, method=method)
            np.testing.assert_allclose(pushed.forces, free.forces - 3.0, atol=1e-9)
        with self.assertRaisesRegex(dyn.Error, "method is 'x'; it must be one of 'articulated', 'kkt'"):
            dyn.constraint_dynamics(model, data, [0.5], [0.0], [0.0], forces, method="x")
        with self.assertRaisesRegex(TypeError, "constraint_dynamics: fext"):
            dyn.constraint_dynamics(model, data, [0.5], [0.0], [0.0], forces, fext=[1.0])

    def test_a_constraint_between_frames_takes_axes_and_a_target(self):
        model = pendulum()
        tip = dyn.frame_constraint("tip", "tip", "universe", other_placement=dyn.SE3.translation(0, 0, -1), axes="OTHER", has_target=True,
                                   free=[False, True, True, True, True, True])
        self.assertEqual(tip.kind, "frames")
        forces = dyn.ConstraintData(dyn.ConstraintSet(model, [tip]))
        velocity, _, error = dyn.compute_constraint_motion(model, dyn.Data(model), [0.1], [2.0], forces)
        np.testing.assert_allclose(velocity, [-2 * np.cos(0.1)], atol=1e-12)
        np.testing.assert_allclose(error, [-np.sin(0.1)], atol=1e-12)


if __name__ == "__main__":
    unittest.main()
