# SPDX-License-Identifier: BSD-2-Clause
"""Models, data and algorithms under Pinocchio's names: results agree with libdyn's own functions, with differences, and with each other."""
import pathlib
import pickle
import unittest
import weakref

import numpy as np

import libdyn as dyn
import libdyn.pinocchio as pin

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


def scrambled():
    """Returns a tree whose joints are not numbered depth first, with joints of many types, and armature."""
    pin.seed(3)
    model = pin.Model()
    root = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root")
    composite = pin.JointModelComposite(pin.JointModelRX()).addJoint(pin.JointModelPZ(), pin.SE3.Random()).addJoint(pin.JointModelSphericalZYX())
    left = model.addJoint(root, pin.JointModelRevoluteUnaligned(1, 2, 3), pin.SE3.Random(), "left")
    right = model.addJoint(root, composite, pin.SE3.Random(), "right")
    hand = model.addJoint(left, pin.JointModelRUBY(), pin.SE3.Random(), "hand")
    foot = model.addJoint(right, pin.JointModelSpherical(), pin.SE3.Random(), "foot")
    slider = model.addJoint(hand, pin.JointModelPX(), pin.SE3.Random(), "slider")
    for i in (root, left, right, hand, foot, slider):
        model.addJointFrame(i)
        model.appendBodyToJoint(i, pin.Inertia.Random(), pin.SE3.Random())
    model.addFrame(pin.Frame("tool", slider, 0, pin.SE3.Random(), pin.OP_FRAME))
    model.armature = 0.1 * np.arange(1.0, model.nv + 1)
    return model


def state_of(model):
    """Returns a configuration, a velocity and an acceleration."""
    random = np.random.default_rng(5)
    q = pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq))
    return (q, *random.normal(size=(2, model.nv)))


class Models(unittest.TestCase):
    def test_joints_keep_the_order_in_which_they_are_added(self):
        model = scrambled()
        self.assertEqual(model.names, ["universe", "root", "left", "right", "hand", "foot", "slider"])
        self.assertEqual(model.idx_qs, [0, 0, 7, 8, 13, 15, 19])
        self.assertEqual(model.idx_vs, [0, 0, 6, 7, 12, 13, 16])
        self.assertEqual(model.subtrees[2], [2, 4, 6])
        self.assertEqual(model.supports[6], [0, 1, 2, 4, 6])
        self.assertEqual((model.nq, model.nv, model.njoints), (20, 17, 7))

    def test_results_do_not_depend_on_the_numbering(self):
        model = scrambled()
        data, (q, v, a) = model.createData(), state_of(model)
        compiled = dyn.compile(model.compiled().description, dissipation=False)
        parts = {"right": ["right part 1", "right part 2", "right"]}
        names = [part for name in model.names[1:] for part in parts.get(name, [name])]
        order_q, order_v = ([k for part in names for k in range(to[part].start, to[part].stop)] for to in (compiled.q_index, compiled.v_index))
        d = dyn.Data(compiled)
        mine_q, mine_v, mine_a = np.zeros(model.nq), np.zeros(model.nv), np.zeros(model.nv)
        mine_q[order_q], mine_v[order_v], mine_a[order_v] = q, v, a
        np.testing.assert_array_equal(pin.rnea(model, data, q, v, a), dyn.rnea(compiled, d, mine_q, mine_v, mine_a)[order_v])
        np.testing.assert_array_equal(pin.crba(model, data, q), dyn.crba(compiled, d, mine_q)[np.ix_(order_v, order_v)])
        np.testing.assert_array_equal(pin.computeJointJacobians(model, data, q), dyn.compute_joint_jacobians(compiled, d, mine_q)[:, order_v])
        self.assertNotEqual(order_v, sorted(order_v))

    def test_equations_of_motion_hold(self):
        model = scrambled()
        data, (q, v, a) = model.createData(), state_of(model)
        tau = pin.rnea(model, data, q, v, a)
        M, nle = pin.crba(model, data, q), pin.nonLinearEffects(model, data, q, v)
        np.testing.assert_allclose(M @ a + nle, tau, atol=1e-10)
        np.testing.assert_allclose(pin.aba(model, data, q, v, tau), a, atol=1e-9)
        np.testing.assert_allclose(pin.computeMinverse(model, data, q) @ M, np.eye(model.nv), atol=1e-9)
        C, g = pin.computeCoriolisMatrix(model, data, q, v), pin.computeGeneralizedGravity(model, data, q)
        np.testing.assert_allclose(C @ v + g, nle, atol=1e-10)
        pin.cholesky.decompose(model, data)
        np.testing.assert_allclose(pin.cholesky.solve(model, data, tau - nle), a, atol=1e-8)
        np.testing.assert_allclose(data.U @ np.diag(data.D) @ data.U.T, M, atol=1e-9)

    def test_a_change_of_the_model_counts_at_the_next_call(self):
        def used(model):
            """Returns the model after an algorithm has run, which may be the last that saw its parts unchanged."""
            pin.crba(model, model.createData(), pin.neutral(model))
            return model

        def heavier(model):
            inertia = model.inertias[6]
            used(model)
            inertia.mass *= 2

        def further(model):
            placement = model.jointPlacements[6]
            used(used(model))
            placement.translation[0] += 0.5

        def further_by_a_view(model):
            view = model.jointPlacements[6].translation
            used(used(model))
            view[0] += 0.5

        def falling(model):
            gravity = model.gravity
            used(model)
            gravity.linear[2] = -1.0

        def replaced(model):
            used(model).inertias[6] = pin.Inertia.Random()

        def replaced_without_a_name(model):
            used(model).inertias[6].mass = 100.0

        for change in (heavier, further, further_by_a_view, falling, replaced, replaced_without_a_name):
            model = scrambled()
            data, q = model.createData(), state_of(model)[0]
            before = pin.computeGeneralizedGravity(model, data, q)
            change(model)
            self.assertGreater(np.abs(pin.computeGeneralizedGravity(model, data, q) - before).max(), 1e-3, change.__name__)
        model = used(scrambled())
        model.armature[6] += 100.0
        self.assertGreater(pin.crba(model, model.createData(), pin.neutral(model))[6, 6], 100)

    def test_a_model_ends_with_its_last_name(self):
        model = scrambled()
        inertias, end = model.inertias, weakref.ref(model)
        pin.crba(model, model.createData(), pin.neutral(model))
        del model
        self.assertIsNone(end())
        inertias[1].mass = 2.0
        inertias[1] = inertias[2]

    def test_a_joint_may_be_added_after_data_was_made(self):
        model = scrambled()
        data = model.createData()
        model.addJoint(1, pin.JointModelRX(), pin.SE3.Identity(), "late")
        with self.assertRaisesRegex(ValueError, "createData"):
            pin.crba(model, data, pin.neutral(model))
        self.assertEqual(pin.crba(model, model.createData(), pin.neutral(model)).shape, (18, 18))

    def test_models_and_data_survive_pickling_and_copying(self):
        model = scrambled()
        data, (q, v, a) = model.createData(), state_of(model)
        model.referenceConfigurations["here"] = q
        pin.rnea(model, data, q, v, a)
        for other in (pickle.loads(pickle.dumps(model)), model.copy()):
            self.assertTrue(other == model)
            np.testing.assert_array_equal(pin.rnea(other, other.createData(), q, v, a), data.tau)
            other.inertias[1].mass += 1
            self.assertFalse(other == model)
        for other in (pickle.loads(pickle.dumps(data)), data.copy()):
            self.assertTrue(other == data)
            other.tau[0] += 1
            self.assertFalse(other == data)

    def test_a_reduced_model_moves_as_the_whole_one_does_with_its_joints_held(self):
        model = scrambled()
        q, v, a = state_of(model)
        locked = [model.getJointId("hand"), model.getJointId("right")]
        reduced = pin.buildReducedModel(model, locked, q)
        self.assertEqual(reduced.names, ["universe", "root", "left", "foot", "slider"])
        rows = [k for i in range(1, model.njoints) if i not in locked for k in range(model.idx_vs[i], model.idx_vs[i] + model.nvs[i])]
        columns = [k for i in range(1, model.njoints) if i not in locked for k in range(model.idx_qs[i], model.idx_qs[i] + model.nqs[i])]
        held = np.zeros(model.nv)
        held[rows] = v[rows]
        data, small = model.createData(), reduced.createData()
        np.testing.assert_allclose(pin.nle(reduced, small, q[columns], v[rows]), pin.nle(model, data, q, held)[rows], atol=1e-10)
        pin.framesForwardKinematics(model, data, q)
        pin.framesForwardKinematics(reduced, small, q[columns])
        whole, part = data.oMf[model.getFrameId("tool")], small.oMf[reduced.getFrameId("tool")]
        np.testing.assert_allclose(part.homogeneous, whole.homogeneous, atol=1e-12)

    def test_an_appended_model_is_carried_by_its_frame(self):
        arm, base = pin.buildSampleModelManipulator(), scrambled()
        placement = pin.SE3.Random()
        both = pin.appendModel(base, arm, base.getFrameId("tool"), placement)
        self.assertEqual(both.nv, arm.nv + base.nv)
        self.assertEqual(both.names[both.parents[both.getJointId("shoulder1_joint")]], "slider")
        mass = pin.computeTotalMass(base) + pin.computeTotalMass(arm)
        self.assertAlmostEqual(pin.computeTotalMass(both), mass)
        with self.assertRaisesRegex(ValueError, "both models"):
            pin.appendModel(base, base, 0, placement)

    def test_urdf_files_give_the_results_of_libdyn(self):
        model = pin.buildModelFromUrdf(BIPED, pin.JointModelFreeFlyer())
        compiled = dyn.compile(dyn.load(BIPED, root="free_flyer", mimic="independent"), dissipation=False)
        q, v, a = (np.asarray(x) for x in (dyn.random_configuration(compiled, 1), np.ones(model.nv), np.ones(model.nv)))
        tau = dyn.rnea(compiled, dyn.Data(compiled), q, v, a)
        np.testing.assert_allclose(pin.rnea(model, model.createData(), q, v, a), tau, rtol=1e-13, atol=1e-12)
        self.assertEqual(model.names[1:], [joint.name for joint in compiled.joints[1:]])
        again = pin.buildModelFromXML(BIPED.read_text(), pin.JointModelFreeFlyer(), "base")
        self.assertEqual(again.names[1], "base")
        self.assertEqual(pin.buildModelFromXML(BIPED.read_text(), pin.JointModelFreeFlyer()), model)
        with self.assertRaises(dyn.Error):
            pin.buildModelFromUrdf("no such file.urdf")

    def test_a_mimic_joint_follows_its_master(self):
        model = pin.buildSampleModelManipulator(True)
        self.assertEqual((model.nq, model.nv, model.njoints), (5, 5, 7))
        free = pin.buildSampleModelManipulator()
        q = np.linspace(0.1, 0.5, 5)
        data, other = model.createData(), free.createData()
        pin.forwardKinematics(model, data, q)
        pin.forwardKinematics(free, other, np.append(q, 2.5 * q[4] + 0.75))
        np.testing.assert_allclose(data.oMi[6].homogeneous, other.oMi[6].homogeneous, atol=1e-14)
        M, G = pin.crba(free, other, np.append(q, 2.5 * q[4] + 0.75)), np.vstack([np.eye(5), [0, 0, 0, 0, 2.5]])
        np.testing.assert_allclose(pin.crba(model, data, q), G.T @ M @ G, atol=1e-12)
        pin.computeAllTerms(model, data, q, np.ones(5))
        np.testing.assert_allclose(data.M @ pin.computeMinverse(model, data, q), np.eye(5), atol=1e-9)
        np.testing.assert_allclose(data.Ag @ np.ones(5), data.hg.vector, atol=1e-12)


class Results(unittest.TestCase):
    def setUp(self):
        self.model = scrambled()
        self.data = self.model.createData()
        self.q, self.v, self.a = state_of(self.model)

    def test_joint_forces_give_the_generalised_forces(self):
        forces = [pin.Force.Random() for _ in range(self.model.njoints)]
        tau = pin.rnea(self.model, self.data, self.q, self.v, self.a, forces)
        for i in range(1, self.model.njoints):
            joint, subspace = self.model.joints[i], self.data.joints[i]
            alone = joint.createData()
            joint.calc(alone, self.q, self.v)
            np.testing.assert_array_equal(alone.S, subspace.S)
            np.testing.assert_allclose(subspace.S @ subspace.joint_v, subspace.v.vector, atol=1e-12)
            rows = slice(joint.idx_v, joint.idx_v + joint.nv)
            inertia_of_rotors = self.model.armature[rows] * self.a[rows]
            if joint.shortname() != "JointModelComposite":
                np.testing.assert_allclose(subspace.S.T @ self.data.f[i].vector + inertia_of_rotors, tau[rows], atol=1e-10)

    def test_fields_are_those_of_the_last_call(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        pin.forwardKinematics(model, data, q, v, a)
        first = data.oMi[6].copy()
        pin.forwardKinematics(model, data, pin.integrate(model, q, v))
        self.assertNotEqual(data.oMi[6], first)
        pin.forwardKinematics(model, data, q)
        self.assertEqual(data.oMi[6], first)
        for i in range(1, model.njoints):
            np.testing.assert_allclose((data.oMi[model.parents[i]] * data.liMi[i]).homogeneous, data.oMi[i].homogeneous, atol=1e-12)

    def test_momentum_and_centres_of_mass_agree(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        pin.ccrba(model, data, q, v)
        momentum = data.hg.copy()
        pin.centerOfMass(model, data, q, v, a)
        mass = pin.computeTotalMass(model)
        np.testing.assert_allclose(momentum.linear, mass * data.vcom[0], atol=1e-10)
        np.testing.assert_allclose(pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a).linear, mass * data.acom[0], atol=1e-9)
        np.testing.assert_allclose(pin.jacobianCenterOfMass(model, data, q) @ v, data.vcom[0], atol=1e-12)
        np.testing.assert_allclose(pin.getJacobianSubtreeCenterOfMass(model, data, 0), data.Jcom, atol=1e-12)
        centre, h = model.getJointId("left"), 1e-6
        J = pin.jacobianSubtreeCenterOfMass(model, data, q, centre)
        ahead, behind = (self.subtree_centre(pin.integrate(model, q, s * h * v), centre) for s in (1, -1))
        np.testing.assert_allclose(J @ v, (ahead - behind) / (2 * h), atol=1e-7)
        c = pin.centerOfMass(model, data, q)
        whole = sum(model.inertias[i].mass * (data.oMi[i].act(model.inertias[i].lever)) for i in range(1, model.njoints))
        np.testing.assert_allclose(c, whole / mass, atol=1e-12)

    def subtree_centre(self, q, joint):
        pin.centerOfMass(self.model, self.data, q)
        return self.data.oMi[joint].act(self.data.com[joint])

    def test_derivatives_agree_with_differences(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        forces = [pin.Force.Random() for _ in range(model.njoints)]
        dq, dv, da = pin.computeRNEADerivatives(model, data, q, v, a, forces)
        tau = data.tau.copy()
        ddq_dq, ddq_dv, Minv = pin.computeABADerivatives(model, data, q, v, tau, forces)
        np.testing.assert_allclose(data.ddq, a, atol=1e-9)
        self.near(dq, lambda s: pin.rnea(model, data, pin.integrate(model, q, s), v, a, forces))
        self.near(dv, lambda s: pin.rnea(model, data, q, v + s, a, forces))
        self.near(ddq_dq, lambda s: pin.aba(model, data, pin.integrate(model, q, s), v, tau, forces), 1e-4)
        self.near(ddq_dv, lambda s: pin.aba(model, data, q, v + s, tau, forces), 1e-4)
        np.testing.assert_allclose(Minv @ da, np.eye(model.nv), atol=1e-8)
        static = pin.computeStaticTorqueDerivatives(model, data, q, forces)
        self.near(static, lambda s: pin.computeStaticTorque(model, data, pin.integrate(model, q, s), forces))

    def near(self, matrix, function, tolerance=1e-5, h=1e-6):
        for k, step in enumerate(h * np.eye(self.model.nv)):
            np.testing.assert_allclose((function(step) - function(-step)) / (2 * h), matrix[:, k], atol=tolerance * max(1, np.abs(matrix).max()))

    def test_derivatives_of_frames_agree_with_differences(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        tool = model.getFrameId("tool")

        def moving(reference, get, *state):
            pin.forwardKinematics(model, data, *state)
            return get(model, data, tool, reference).vector

        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        for reference in (pin.LOCAL, pin.WORLD):
            v_dq, v_dv = pin.getFrameVelocityDerivatives(model, data, tool, reference)
            again, a_dq, a_dv, a_da = pin.getFrameAccelerationDerivatives(model, data, tool, reference)
            np.testing.assert_array_equal(again, v_dq)
            self.near(v_dq, lambda s: moving(reference, pin.getFrameVelocity, pin.integrate(model, q, s), v, a))
            self.near(v_dv, lambda s: moving(reference, pin.getFrameVelocity, q, v + s, a))
            self.near(a_dq, lambda s: moving(reference, pin.getFrameAcceleration, pin.integrate(model, q, s), v, a))
            self.near(a_dv, lambda s: moving(reference, pin.getFrameAcceleration, q, v + s, a))
            self.near(a_da, lambda s: moving(reference, pin.getFrameAcceleration, q, v, a + s))
        # In LOCAL_WORLD_ALIGNED the point stays where it is while q changes.
        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        aligned = pin.getFrameVelocityDerivatives(model, data, tool, pin.LOCAL_WORLD_ALIGNED)
        _, a_dq, a_dv, _ = pin.getFrameAccelerationDerivatives(model, data, tool, pin.LOCAL_WORLD_ALIGNED)
        point = pin.SE3(np.eye(3), -pin.updateFramePlacement(model, data, tool).translation)

        def there(get, *state):
            return point.act(pin.Motion(moving(pin.WORLD, get, *state))).vector

        self.near(aligned[0], lambda s: there(pin.getFrameVelocity, pin.integrate(model, q, s), v, a))
        self.near(aligned[1], lambda s: there(pin.getFrameVelocity, q, v + s, a))
        self.near(a_dq, lambda s: there(pin.getFrameAcceleration, pin.integrate(model, q, s), v, a))
        self.near(a_dv, lambda s: there(pin.getFrameAcceleration, q, v + s, a))
        pin.computeForwardKinematicsDerivatives(model, data, q, v, a)
        slider, placement = model.frames[tool].parentJoint, model.frames[tool].placement
        for reference in (pin.LOCAL, pin.LOCAL_WORLD_ALIGNED):
            v_dq, a_dq, a_dv, a_da = pin.getPointClassicAccelerationDerivatives(model, data, slider, placement, reference)
            self.near(v_dq, lambda s: moving(reference, pin.getFrameVelocity, pin.integrate(model, q, s), v, a)[:3])
            self.near(a_dq, lambda s: moving(reference, pin.getFrameClassicalAcceleration, pin.integrate(model, q, s), v, a)[:3])
            self.near(a_dv, lambda s: moving(reference, pin.getFrameClassicalAcceleration, q, v + s, a)[:3])
            np.testing.assert_array_equal(pin.getPointVelocityDerivatives(model, data, slider, placement, reference)[0], v_dq)

    def test_regressors_times_parameters_are_results(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        parameters = np.concatenate([model.inertias[i].toDynamicParameters() for i in range(1, model.njoints)])
        tau = pin.rnea(model, data, q, v, a) - model.armature * a
        np.testing.assert_allclose(pin.computeJointTorqueRegressor(model, data, q, v, a) @ parameters, tau, atol=1e-10)
        potential = pin.computePotentialEnergy(model, data, q)
        self.assertAlmostEqual(pin.computePotentialEnergyRegressor(model, data, q) @ parameters, potential)
        kinetic = pin.computeKineticEnergy(model, data, q, v) - 0.5 * model.armature @ v**2
        self.assertAlmostEqual(pin.computeKineticEnergyRegressor(model, data, q, v) @ parameters, kinetic)

    def test_constraints_given_by_jacobian_and_by_frame_agree(self):
        model, data, q, v = self.model, self.data, self.q, self.v
        tool = model.frames[model.getFrameId("tool")]
        for kind, rows in ((pin.CONTACT_6D, 6), (pin.CONTACT_3D, 3)):
            contact = pin.RigidConstraintModel(kind, model, tool.parentJoint, tool.placement)
            results = contact.createData()
            tau = np.ones(model.nv)
            ddq = pin.constraintDynamics(model, data, q, v, tau, [contact], [results]).copy()
            forces = data.lambda_c.copy()
            pin.computeJointJacobiansTimeVariation(model, data, q, v)
            J = pin.getFrameJacobian(model, data, model.getFrameId("tool"), pin.LOCAL)
            pin.forwardKinematics(model, data, q, v, np.zeros(model.nv))
            drift = (pin.getFrameAcceleration if rows == 6 else pin.getFrameClassicalAcceleration)(model, data, model.getFrameId("tool")).vector
            by_jacobian = pin.forwardDynamics(model, data, q, v, tau, J[:rows], drift[:rows])
            np.testing.assert_allclose(by_jacobian, ddq, atol=1e-8)
            np.testing.assert_allclose(data.lambda_c, forces, atol=1e-8)
            after = pin.impulseDynamics(model, data, q, v, [contact], [results], 0.3).copy()
            np.testing.assert_allclose(pin.impulseDynamics(model, data, q, v, J[:rows], 0.3), after, atol=1e-9)


    def test_feedback_closes_a_loop_that_is_open(self):
        model = pin.buildSampleModelHumanoid()
        model.gravity = pin.Motion.Zero()
        data, q, v = model.createData(), pin.neutral(model), np.zeros(model.nv)
        left, right = model.getJointId("larm_wrist2_joint"), model.getJointId("rarm_wrist2_joint")
        q = pin.integrate(model, q, np.linspace(-0.3, 0.5, model.nv))
        for kind in (pin.CONTACT_3D, pin.CONTACT_6D):
            loop = pin.RigidConstraintModel(kind, model, left, pin.SE3.Identity(), right, pin.SE3.Identity())
            loop.corrector.Kp[:], loop.corrector.Kd[:] = 100.0, 20.0
            results, x, rate, errors = loop.createData(), q.copy(), v.copy(), []
            for _ in range(200):
                rate += 5e-3 * pin.constraintDynamics(model, data, x, rate, np.zeros(model.nv), [loop], [results])
                x = pin.integrate(model, x, 5e-3 * rate)
                errors.append(np.linalg.norm(results.c1Mc2.translation))
            self.assertGreater(errors[0], 0.1)
            self.assertLess(errors[-1], 0.01 * errors[0])
        loop.corrector.Kp[0] = 1.0
        with self.assertRaisesRegex(NotImplementedError, "corrector.Kp differs"):
            pin.constraintDynamics(model, data, q, v, v, [loop], [results])

    def test_forces_in_world_axes_are_those_in_local_axes_turned(self):
        model, data, q, v = self.model, self.data, self.q, self.v
        tau, tool = np.ones(model.nv), model.frames[model.getFrameId("tool")]

        def solved(kind, reference, at=q):
            contacts = [pin.RigidConstraintModel(kind, model, tool.parentJoint, tool.placement, reference)]
            datas = [x.createData() for x in contacts]
            ddq = pin.constraintDynamics(model, data, at, v, tau, contacts, datas)
            return ddq, data.lambda_c.copy(), datas[0].oMc1.rotation.copy(), contacts, datas

        for kind in (pin.CONTACT_3D, pin.CONTACT_6D):
            ddq, forces, R, *_ = solved(kind, pin.LOCAL)
            again, turned, _, contacts, datas = solved(kind, pin.LOCAL_WORLD_ALIGNED)
            np.testing.assert_allclose(again, ddq, atol=1e-9)
            np.testing.assert_allclose(turned.reshape(-1, 3), forces.reshape(-1, 3) @ R.T, atol=1e-8)
            derivatives = pin.computeConstraintDynamicsDerivatives(model, data, contacts, datas)
            self.near(derivatives[0], lambda s: solved(kind, pin.LOCAL_WORLD_ALIGNED, pin.integrate(model, q, s))[0], 1e-4)
            self.near(derivatives[3], lambda s: solved(kind, pin.LOCAL_WORLD_ALIGNED, pin.integrate(model, q, s))[1], 1e-4)
            pin.computeJointJacobians(model, data, q)
            J = pin.getConstraintsJacobian(model, data, contacts, datas)
            frame = pin.getFrameJacobian(model, data, model.getFrameId("tool"), pin.LOCAL_WORLD_ALIGNED)
            np.testing.assert_allclose(J, frame[: len(J)], atol=1e-12)

    def test_contact_forces_with_friction_are_in_their_cones_and_complementary(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        tool = model.frames[model.getFrameId("tool")]
        for reference in (pin.LOCAL, pin.LOCAL_WORLD_ALIGNED):
            contact = pin.RigidConstraintModel(pin.CONTACT_3D, model, tool.parentJoint, tool.placement, reference)
            results, cone, R = contact.createData(), pin.CoulombFrictionCone(0.4), np.full(3, 0.5)
            settings = pin.ProximalSettings(1e-14, 1e-14, 1e-6, 1000)
            tau = pin.contactInverseDynamics(model, data, q, v, a, 1e-3, [contact], [results], [cone], R, np.array([0, 0, -3.0]), settings)
            force = data.lambda_c.copy()
            self.assertTrue(cone.isInside(force, 1e-9))
            self.assertGreater(force[2], 1)
            J = pin.getConstraintJacobian(model, data, contact, results)
            np.testing.assert_allclose(tau, pin.rnea(model, data, q, v, a) - J.T @ force, atol=1e-8)
            velocity = J @ (v + 1e-3 * a) + np.array([0, 0, -3.0]) + R * 1e-3 * force
            shifted = velocity + cone.computeNormalCorrection(velocity)
            self.assertTrue(cone.dual().isInside(shifted, 1e-6))
            self.assertAlmostEqual(force @ shifted / np.linalg.norm(force), 0, places=5)

    def test_projections_on_cones_are_the_nearest_vectors(self):
        random = np.random.default_rng(2)
        for f in random.normal(size=(200, 3)):
            for cone in (pin.CoulombFrictionCone(0.7), pin.DualCoulombFrictionCone(0.7)):
                x = cone.project(f)
                self.assertTrue(cone.isInside(x, 1e-12))
                self.assertAlmostEqual(x @ (f - x), 0)
                self.assertTrue(cone.dual().isInside(x - f, 1e-12))

    def test_factors_of_motion_and_forces_are_those_of_their_matrix(self):
        model, data, q = self.model, self.data, self.q
        tool = model.frames[model.getFrameId("tool")]
        contacts = [pin.RigidConstraintModel(pin.CONTACT_3D, model, tool.parentJoint, tool.placement)]
        datas = [x.createData() for x in contacts]
        pin.initConstraintDynamics(model, data, contacts)
        M = pin.crba(model, data, q)
        pin.computeJointJacobians(model, data, q)
        factors = data.contact_chol
        factors.compute(model, data, contacts, datas, 0.01)
        J = pin.getConstraintJacobian(model, data, contacts[0], datas[0])
        A = np.block([[-0.01 * np.eye(3), J], [J.T, M]])
        np.testing.assert_allclose(factors.U @ np.diag(factors.D) @ factors.U.T, A, atol=1e-9)
        np.testing.assert_array_equal(np.triu(factors.U), factors.U)
        np.testing.assert_allclose(A @ factors.solve(np.arange(20.0)), np.arange(20.0), atol=1e-7)
        np.testing.assert_allclose(factors.getInverseOperationalSpaceInertiaMatrix(), J @ np.linalg.solve(M, J.T) + 0.01 * np.eye(3), atol=1e-9)
        np.testing.assert_allclose((data.oMi[tool.parentJoint] * tool.placement).homogeneous, datas[0].oMc1.homogeneous, atol=1e-14)

    def test_many_states_in_threads_give_the_results_of_single_ones(self):
        model, pool = self.model, pin.ModelPool(self.model, 2)
        states = [state_of(model) for _ in range(11)]
        q, v, a = (np.array(x).T for x in zip(*states))
        tau, out = pin.rneaInParallel(2, pool, q, v, a), np.empty((model.nv, 11))
        for k, state in enumerate(states):
            np.testing.assert_allclose(tau[:, k], pin.rnea(model, self.data, *state), atol=1e-11)
        self.assertIs(pin.abaInParallel(1, pool, q, v, tau, out), out)
        np.testing.assert_allclose(out, a, atol=1e-8)
        with self.assertRaisesRegex(ValueError, "v has shape"):
            pin.rneaInParallel(1, pool, q, v[:, :3], a)
        with self.assertRaisesRegex(ValueError, "num_threads is 3"):
            pin.rneaInParallel(3, pool, q, v, a)


class Interface(unittest.TestCase):
    def test_wrong_arguments_are_named(self):
        model = pin.buildSampleModelManipulator()
        data, q = model.createData(), np.zeros(6)
        for call, message in (
            (lambda: pin.rnea(model, data, q, np.zeros(5), q), "rnea: v has shape"),
            (lambda: pin.crba(model, data, np.zeros((2, 3))), "crba: q has shape"),
            (lambda: pin.aba(model, data, q, q, q, [pin.Force.Zero()]), "fext has 1 forces"),
            (lambda: pin.computeJointJacobian(model, data, q, 99), "joint_id is 99"),
            (lambda: pin.getFrameJacobian(model, model.createData(), 1), "call computeJointJacobians"),
            (lambda: pin.getJointVelocityDerivatives(model, data, 1, pin.LOCAL), "call computeForwardKinematicsDerivatives"),
            (lambda: model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "x", np.zeros(3)), "effortLimit has shape"),
            (lambda: model.addJoint(77, pin.JointModelRX(), pin.SE3.Identity(), "x"), "parent_id is 77"),
        ):
            with self.assertRaisesRegex(ValueError, message):
                call()
        for call, message in (
            (lambda: pin.rnea(model, data, "text", q, q), "rnea: q must be numbers"),
            (lambda: pin.crba(None, data, q), "crba: model must be a Model, not NoneType"),
            (lambda: pin.crba(model, model, q), "crba: data must be a Data, not Model"),
            (lambda: pin.neutral(data), "neutral: model must be a Model, not Data"),
            (lambda: pin.computeJointJacobian(model, data, q, 1.5), "joint_id must be an integer, not float"),
            (lambda: model.addJoint(0, "RX", pin.SE3.Identity(), "x"), "joint_model must be a JointModel, not str"),
        ):
            with self.assertRaisesRegex(TypeError, message):
                call()
        with self.assertRaisesRegex(RuntimeError, "no limits"):
            pin.randomConfiguration(pin.buildSampleModelHumanoid())

    def test_missing_names_tell_the_way_of_libdyn(self):
        with self.assertRaisesRegex(NotImplementedError, "BatchData"):
            pin.GeometryPool
        self.assertFalse(hasattr(pin, "buildModelFromSdf"))
        with self.assertRaises(AttributeError):
            pin.noSuchThing

    def test_columns_and_keywords_are_arguments(self):
        model = pin.buildSampleModelManipulator()
        data, q = model.createData(), np.linspace(0, 1, 6)
        M = pin.crba(model, data, q)
        np.testing.assert_array_equal(pin.crba(model, data, q[:, None]), M)
        np.testing.assert_array_equal(pin.crba(model=model, data=data, q=list(q), convention=pin.Convention.WORLD), M)
        J = pin.computeFrameJacobian(model, data, q, 5, reference_frame=pin.WORLD)
        np.testing.assert_array_equal(pin.computeFrameJacobian(model, data, q, 5, pin.WORLD), J)

    def test_robot_wrapper_calls_the_same_functions(self):
        robot = pin.RobotWrapper.BuildFromURDF(BIPED, [], pin.JointModelFreeFlyer())
        q, v = robot.q0, np.ones(robot.nv)
        np.testing.assert_array_equal(robot.mass(q), pin.crba(robot.model, robot.data, q))
        centre, velocity = robot.com(q, v)
        np.testing.assert_allclose(robot.Jcom(q) @ v, velocity, atol=1e-12)
        np.testing.assert_allclose(robot.com(q), centre, atol=1e-14)
        reduced = robot.buildReducedRobot([robot.model.names[2]])
        self.assertEqual(reduced.nv, robot.nv - robot.model.nvs[2])


if __name__ == "__main__":
    unittest.main()
