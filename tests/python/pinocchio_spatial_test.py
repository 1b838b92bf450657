# SPDX-License-Identifier: BSD-2-Clause
"""Spatial quantities, rotations and their exponentials under the names of Pinocchio."""
import copy
import math
import pickle
import resource
import sys
import unittest

import numpy as np

import libdyn as dyn
from libdyn.pinocchio import _random, explog, rpy
from libdyn.pinocchio.inertia import Inertia, LogCholeskyParameters, PseudoInertia
from libdyn.pinocchio.rotations import AngleAxis, Quaternion
from libdyn.pinocchio.spatial import SE3, Force, Motion, SE3ToXYZQUAT, SE3ToXYZQUATtuple, XYZQUATToSE3, classicAcceleration, own, skew
from libdyn.pinocchio.symmetric3 import Symmetric3


def close(a, b, atol=1e-13):
    np.testing.assert_allclose(np.asarray(a), np.asarray(b), rtol=0, atol=atol)


def rodrigues(axis, angle):
    """Returns a rotation matrix in extended precision."""
    n = np.array(axis, dtype=np.longdouble)
    n /= np.sqrt(n @ n)
    K = np.array([[0, -n[2], n[1]], [n[2], 0, -n[0]], [-n[1], n[0], 0]], dtype=np.longdouble)
    t = np.longdouble(angle)
    return np.eye(3, dtype=np.longdouble) + np.sin(t) * K + (1 - np.cos(t)) * (K @ K)


class Spatial(unittest.TestCase):
    def setUp(self):
        _random.seed(7)

    def test_parts_are_views(self):
        M, v, f, Y = SE3.Random(), Motion.Random(), Force.Random(), Inertia.Random()
        for x, part in ((M, "translation"), (v, "linear"), (v, "angular"), (v, "vector"), (v, "np"), (f, "vector"), (Y, "lever")):
            getattr(x, part)[1] = 42.0
            self.assertEqual(getattr(x, part)[1], 42.0, part)
        M.rotation[0, 2] = 5.0
        self.assertEqual(M.homogeneous[0, 2], 5.0)
        translation = M.translation
        M.translation = [1, 2, 3]
        close(translation, [1, 2, 3], 0)
        del M
        close(translation, [1, 2, 3], 0)

    def test_functions_of_libdyn_take_them(self):
        robot = dyn.Model()
        placement = SE3(np.eye(3), [1, 0, 0])
        hinge = dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]}, placement)
        robot.add_body("rod", 0, hinge, Inertia(2.0, [0, 0, -1], 0.01 * np.eye(3)))
        self.assertEqual(robot.bodies[1].inertia.mass, 2.0)
        self.assertEqual(robot.bodies[1].joint.placement, placement)

    def test_operators_return_their_own_classes(self):
        M, v, f, Y = SE3.Random(), Motion.Random(), Force.Random(), Inertia.Random()
        for x in (M * M, M.inverse(), ~M, M.act(M), M.actInv(M), M @ M, M.copy(), copy.copy(M), copy.deepcopy(M), pickle.loads(pickle.dumps(M))):
            self.assertIs(type(x), SE3)
        for x in (v + v, v - v, -v, 2 * v, v * 2, v / 2, v ^ v, v.cross(v), M * v, M.actInv(v), v.se3Action(M), pickle.loads(pickle.dumps(v))):
            self.assertIs(type(x), Motion)
        for x in (f + f, -f, 2 * f, f / 2, v ^ f, M * f, M.actInv(f), Y * v, Y.vxiv(v), copy.deepcopy(f), pickle.loads(pickle.dumps(f))):
            self.assertIs(type(x), Force)
        for x in (Y + Y, Y - Y, M * Y, M.actInv(Y), Y.se3Action(M), copy.copy(Y), pickle.loads(pickle.dumps(Y))):
            self.assertIs(type(x), Inertia)
        v += v
        Y += Y
        self.assertIs(type(v), Motion)
        self.assertIs(type(Y), Inertia)
        with self.assertRaises(TypeError):
            v + f

    def test_actions_agree_with_their_matrices(self):
        M, N, v, f, Y = SE3.Random(), SE3.Random(), Motion.Random(), Force.Random(), Inertia.Random()
        close((M * N).homogeneous, M.homogeneous @ N.homogeneous)
        close((M.actInv(N)).homogeneous, np.linalg.inv(M.homogeneous) @ N.homogeneous)
        close((M * v).vector, M.action @ v.vector)
        close(M.actInv(v).vector, M.actionInverse @ v.vector)
        close((M * f).vector, M.dualAction @ f.vector)
        close(M.dualAction, np.linalg.inv(M.action).T)
        close((M * Y).matrix(), M.dualAction @ Y.matrix() @ M.actionInverse, 1e-12)
        close((v ^ v).vector, v.action @ v.vector)
        close((v ^ f).vector, v.dualAction @ f.vector)
        close((Y * v).vector, Y.matrix() @ v.vector)
        close(Y.inverse() @ Y.matrix(), np.eye(6), 1e-11)
        close(Y.variation(v), v.dualAction @ Y.matrix() - Y.matrix() @ v.action, 1e-12)
        close(Y.vxiv(v).vector, v.dualAction @ Y.matrix() @ v.vector, 1e-12)
        self.assertAlmostEqual(Y.vtiv(v), v.vector @ Y.matrix() @ v.vector, 12)
        self.assertAlmostEqual(v.dot(f), v.vector @ f.vector, 13)
        close(M * np.array([1.0, 2, 3]), M.rotation @ [1, 2, 3] + M.translation)
        close(v.homogeneous, np.vstack([np.column_stack([skew(v.angular), v.linear]), np.zeros(4)]))

    def test_constructors_take_what_pinocchio_takes(self):
        M = SE3.Random()
        for other in (SE3(M), SE3(M.rotation, M.translation), SE3(np.array(M)), SE3(rotation=M.R, translation=M.p), SE3(dyn.SE3(M.R, M.p))):
            self.assertEqual(other, M)
        self.assertTrue(SE3(Quaternion(M.rotation), M.translation).isApprox(M))
        self.assertTrue(SE3(1).isIdentity())
        mirror = np.diag([1.0, 1, -1])
        close(SE3(mirror, np.zeros(3)).rotation, mirror, 0)
        v = Motion.Random()
        named = Motion(linear=v.linear, angular=v.angular)
        for other in (Motion(v), Motion(v.linear, v.angular), Motion(np.array(v)), Motion(v.vector.reshape(6, 1)), named):
            self.assertEqual(other, v)
        self.assertFalse(Motion.Zero() == v)

    def test_wrong_arguments_are_named(self):
        for call, error, text in (
            (lambda: SE3(np.eye(3), np.zeros(4)), ValueError, "translation"),
            (lambda: SE3(np.eye(3)), ValueError, "array"),
            (lambda: XYZQUATToSE3([1, 2, 3]), ValueError, "v has shape"),
            (lambda: Inertia(-1.0, np.zeros(3), np.eye(3)), ValueError, "mass"),
            (lambda: Inertia(1.0, np.zeros(3), np.arange(9.0).reshape(3, 3)), ValueError, "symmetric"),
            (lambda: Inertia.FromDynamicParameters(np.zeros(3)), ValueError, "dynamic_parameters"),
            (lambda: explog.exp3("x"), TypeError, "w must be numbers"),
            (lambda: SE3.Random().act("x"), TypeError, "act"),
            (lambda: SE3.Random().isApprox(np.eye(4)), TypeError, "other must be a SE3, not ndarray"),
            (lambda: Motion.Random().dot(Motion.Random()), TypeError, "other must be a Force, not Motion"),
            (lambda: Motion.Random().isApprox(Force.Random()), TypeError, "other must be a Motion"),
            (lambda: Quaternion().slerp(0.5, [0, 0, 0, 1]), TypeError, "other must be a Quaternion"),
            (lambda: SE3ToXYZQUAT(np.eye(4)), TypeError, "M must be a SE3"),
            (lambda: explog.log3(np.zeros(4)), ValueError, "quaternion"),
        ):
            with self.assertRaisesRegex(error, text):
                call()

    def test_results_leave_no_memory_behind(self):
        M, v, f, Y = SE3.Random(), Motion.Random(), Force.Random(), Inertia.Random()

        def work(count):
            for _ in range(count):
                M * M, M.inverse(), v + v, v ^ f, Y * v, M.copy(), M.translation, explog.log6(M), Y + Y  # noqa: B018

        work(2000)
        references = [sys.getrefcount(cls) for cls in (SE3, Motion, Force, Inertia)]
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        work(20000)
        self.assertEqual([sys.getrefcount(cls) for cls in (SE3, Motion, Force, Inertia)], references)
        self.assertLess(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before, 2000)  # kB; 180,000 lost poses would be 18,000

    def test_results_of_libdyn_become_classes_of_this_package_only(self):
        for x, cls in ((dyn.SE3(), SE3), (dyn.Motion(), Motion), (dyn.Force(), Force), (dyn.Inertia(), Inertia)):
            self.assertIs(type(own(x)), cls)
            self.assertIs(own("text"), "text")
            for wrong in (int, dyn.JointDescription, Motion if cls is not Motion else Force):
                with self.assertRaises(TypeError):
                    dyn._core._as(wrong, x)

    def test_no_protocol_of_pickle_ends_the_process(self):
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1):
            for x in (SE3.Random(), Motion.Random(), Inertia.Random(), Quaternion.Random(), Symmetric3.Random()):
                self.assertEqual(pickle.loads(pickle.dumps(x, protocol)), x)
        for x in (dyn.LOCAL, dyn.JointDescription()):
            with self.assertRaises(TypeError):
                pickle.dumps(x, 1)
        with self.assertRaises(TypeError):
            dyn.SE3.__mro__[1]()

    def test_interpolation_reaches_both_ends(self):
        A, B = SE3.Random(), SE3.Random()
        close(SE3.Interpolate(A, B, 0.0), A)
        close(SE3.Interpolate(A, B, 1.0), B)
        half = SE3.Interpolate(A, B, 0.5)
        close(explog.log6(A.actInv(half)).vector, explog.log6(half.actInv(B)).vector)

    def test_xyzquat_keeps_the_pose_and_the_sign_of_eigen(self):
        for _ in range(50):
            M = SE3.Random()
            close(XYZQUATToSE3(SE3ToXYZQUAT(M)), M, 2e-15)
            self.assertEqual(SE3ToXYZQUATtuple(M), tuple(SE3ToXYZQUAT(M)))
            q, R = SE3ToXYZQUAT(M)[3:], M.rotation
            decisive = q[3] if np.trace(R) > 0 else q[int(np.argmax(np.diag(R)))]
            self.assertGreater(decisive, 0)

    def test_the_classical_acceleration_is_that_of_a_point(self):
        v, a, M = Motion.Random(), Motion.Random(), SE3.Random()
        close(classicAcceleration(v, a), a.linear + np.cross(v.angular, v.linear))
        r = M.translation
        point = a.linear + np.cross(a.angular, r) + np.cross(v.angular, v.linear + np.cross(v.angular, r))
        close(classicAcceleration(v, a, M), M.rotation.T @ point)


class Inertias(unittest.TestCase):
    def setUp(self):
        _random.seed(3)

    def test_taking_a_part_away_undoes_adding_it(self):
        A, B = Inertia.Random(), Inertia.Random()
        close((A + B).matrix(), A.matrix() + B.matrix(), 1e-12)
        close((A + B - B).matrix(), A.matrix(), 1e-12)
        self.assertTrue((A - A).isZero(1e-12))

    def test_shapes_have_the_moments_of_their_volumes(self):
        # Independent: second moments by Gauss-Legendre quadrature over slices across z.
        x, w = np.polynomial.legendre.leggauss(60)

        def moments(radius_at, lower, upper, cuts=()):
            edges = [lower, *cuts, upper]
            total, mzz, mrr = 0.0, 0.0, 0.0
            for a, b in zip(edges, edges[1:]):
                z, dz = 0.5 * (a + b) + 0.5 * (b - a) * x, 0.5 * (b - a) * w
                area = math.pi * radius_at(z) ** 2
                total, mzz, mrr = total + area @ dz, mzz + (area * z * z) @ dz, mrr + (area * radius_at(z) ** 2 / 4) @ dz
            return mzz / total, mrr / total

        r, h = 0.3, 0.8
        for Y, (mzz, mrr) in (
            (Inertia.FromCylinder(2.0, r, h), moments(lambda z: np.full_like(z, r), -h / 2, h / 2)),
            (Inertia.FromSphere(2.0, r), moments(lambda z: np.sqrt(r * r - z * z), -r, r)),
            (
                Inertia.FromCapsule(2.0, r, h),
                moments(lambda z: np.sqrt(np.maximum(r * r - np.maximum(np.abs(z) - h / 2, 0) ** 2, 0)), -h / 2 - r, h / 2 + r, (-h / 2, h / 2)),
            ),
        ):
            close(np.diag(Y.inertia), 2.0 * np.array([mrr + mzz, mrr + mzz, 2 * mrr]), 1e-9)
        close(np.diag(Inertia.FromBox(12.0, 1, 2, 3).inertia), [13, 10, 5])
        close(np.diag(Inertia.FromEllipsoid(5.0, 1, 2, 3).inertia), [13, 10, 5])

    def test_parameters_lead_back_to_the_inertia(self):
        Y = Inertia.Random()
        parameters = Y.toDynamicParameters()
        close(parameters[1:4], Y.mass * Y.lever)
        close(Inertia.FromDynamicParameters(parameters).matrix(), Y.matrix(), 1e-12)
        pseudo = Y.toPseudoInertia()
        close(np.array(pseudo), pseudo.toMatrix(), 0)
        close(PseudoInertia.FromMatrix(pseudo.toMatrix()).toInertia().matrix(), Y.matrix(), 1e-12)
        theta = LogCholeskyParameters(np.linspace(-0.3, 0.4, 10))
        close(theta.toPseudoInertia().toLogCholeskyParameters().parameters, theta.parameters)
        close(Inertia.FromLogCholeskyParameters(theta).matrix(), theta.toInertia().matrix(), 0)

    def test_the_jacobian_of_log_cholesky_parameters_is_their_derivative(self):
        theta, h = np.linspace(-0.3, 0.4, 10), 1e-6
        J = LogCholeskyParameters(theta).calculateJacobian()
        for k, e in enumerate(np.eye(10)):
            difference = LogCholeskyParameters(theta + h * e).toDynamicParameters() - LogCholeskyParameters(theta - h * e).toDynamicParameters()
            close(J[:, k], difference / (2 * h), 1e-8)

    def test_symmetric_matrices_keep_six_entries(self):
        S = Symmetric3(1, 2, 3, 4, 5, 6)
        close(S.matrix(), [[1, 2, 4], [2, 3, 5], [4, 5, 6]], 0)
        self.assertEqual(Symmetric3(S.matrix()), S)
        S.data[0] = 9
        self.assertEqual(S.matrix()[0, 0], 9)
        R, v = SE3.Random().rotation, np.array([1.0, -2, 3])
        close(S.rotate(R).matrix(), R @ S.matrix() @ R.T)
        self.assertAlmostEqual(S.vtiv(v), v @ S.matrix() @ v)
        close(Symmetric3.vxs(v, S), skew(v) @ S.matrix())
        close((S + S - S).matrix(), S.matrix())
        self.assertEqual(pickle.loads(pickle.dumps(S)), S)


class Rotations(unittest.TestCase):
    def setUp(self):
        _random.seed(5)

    def test_exponentials_are_exact_at_small_angles(self):
        for size in (0.0, 1e-300, 1e-160, 1e-9, 1e-5):
            w = size * np.array([1.0, -2.0, 0.5])
            K = skew(w)
            close(explog.exp3(w), np.eye(3) + K + K @ K / 2 + K @ K @ K / 6, 2.3e-16)
            close(explog.log3(explog.exp3(w)), w, 2e-16 * (size > 0))
            close(explog.Jexp3(w), np.eye(3) - K / 2 + K @ K / 6 - K @ K @ K / 24, 2.3e-16)

    def test_logarithms_are_exact_near_pi(self):
        for gap in (0.0, 1e-15, 1e-12, 1e-9, 1e-5, 1e-2):
            angle = math.pi - gap
            for axis in ([1.0, 0, 0], [0.6, 0, -0.8], [1.0, 2, 2]):
                n = np.array(axis) / np.linalg.norm(axis)
                w = explog.log3(rodrigues(axis, angle).astype(float))
                self.assertAlmostEqual(np.linalg.norm(w), angle, delta=1e-15)
                close(np.abs(w @ n), angle, 2e-15)

    def test_quaternions_and_matrices_have_the_same_logarithm(self):
        for _ in range(50):
            q = Quaternion.Random()
            close(explog.exp3(explog.log3(q)), q.matrix(), 1e-15)
            close(explog.log3(q.coeffs()), explog.log3(q.matrix()), 3e-15)
            close(Quaternion(explog.exp3_quat(explog.log3(q))).matrix(), q.matrix(), 1e-15)
        theta = np.zeros(1)
        w = explog.log3(q.matrix(), theta)
        self.assertEqual(theta[0], np.linalg.norm(w))

    def test_jacobians_are_derivatives(self):
        h = 1e-6
        v = Motion(np.array([0.3, -0.2, 0.5, 0.7, -0.4, 1.1]))
        J = explog.Jexp6(v)
        for k, e in enumerate(np.eye(6)):
            difference = explog.log6(explog.exp6(v).actInv(explog.exp6(v.vector + h * e))).vector
            difference = difference - explog.log6(explog.exp6(v).actInv(explog.exp6(v.vector - h * e))).vector
            close(J[:, k], difference / (2 * h), 1e-9)
        close(explog.Jlog6(explog.exp6(v)) @ J, np.eye(6))
        w, u = v.angular.copy(), np.array([0.1, 0.9, -0.3])
        R = explog.exp3(w)
        close(explog.Jlog3(R) @ explog.Jexp3(w), np.eye(3))
        rate = (explog.Jlog3(R @ explog.exp3(h * u)) - explog.Jlog3(R @ explog.exp3(-h * u))) / (2 * h)
        close(explog.Hlog3(R, u), rate, 1e-9)
        close(explog.Hlog3(np.eye(3), u), skew(u) / 2)

    def test_poses_and_their_vectors_have_one_logarithm(self):
        M = SE3.Random()
        close(explog.exp6(explog.log6(M)), M, 1e-15)
        close(explog.log6_quat(SE3ToXYZQUAT(M)).vector, explog.log6(M).vector, 1e-14)
        close(XYZQUATToSE3(explog.exp6_quat(explog.log6(M).vector)), M, 2e-15)
        close(explog.log(explog.exp(np.arange(6.0) / 5)).vector, np.arange(6.0) / 5)

    def test_products_of_quaternions_are_those_of_their_matrices(self):
        a, b, x = Quaternion.Random(), Quaternion.Random(), np.array([1.0, 2, 3])
        close((a * b).matrix(), a.matrix() @ b.matrix())
        close(a * x, a.matrix() @ x)
        close((a * a.inverse()).coeffs(), [0, 0, 0, 1])
        close(a.slerp(0.5, b).matrix(), a.matrix() @ explog.exp3(explog.log3(a.matrix().T @ b.matrix()) / 2))
        self.assertAlmostEqual(a.angularDistance(b), np.linalg.norm(explog.log3(a.matrix().T @ b.matrix())))
        self.assertEqual((a.x, a[3]), (a.coeffs()[0], a.w))
        self.assertEqual(pickle.loads(pickle.dumps(a)), a)
        self.assertEqual(Quaternion(0.5, 0.1, 0.2, 0.3).coeffs().tolist(), [0.1, 0.2, 0.3, 0.5])

    def test_a_rotation_between_directions_turns_one_into_the_other(self):
        for a, b in (([1, 0, 0], [0, 1, 0]), ([1, 0, 0], [-1, 0, 0]), ([0, 0, 2], [0, 1e-9, -3]), ([1, 2, 3], [1, 2, 3])):
            q = Quaternion.FromTwoVectors(np.array(a, float), np.array(b, float))
            close(q * (np.array(a) / np.linalg.norm(a)), np.array(b) / np.linalg.norm(b), 1e-8)
            self.assertAlmostEqual(q.norm(), 1.0, 14)

    def test_axis_and_angle_lead_back(self):
        aa = AngleAxis(1.2, np.array([0.6, 0, 0.8]))
        for other in (AngleAxis(aa.matrix()), AngleAxis(Quaternion(aa)), AngleAxis(aa)):
            self.assertTrue(other.isApprox(aa, 1e-14))
        close(aa.inverse().matrix(), aa.matrix().T)
        close((aa * aa).matrix(), AngleAxis(2.4, aa.axis).matrix())

    def test_roll_pitch_and_yaw_lead_back(self):
        for angles in ([0.3, -0.4, 2.0], [3.0, 1.5, -3.0], [0.5, math.pi / 2, 0.2], [0.5, -math.pi / 2, 0.2], [0.1, math.pi / 2 - 1e-9, 1.0]):
            R = rpy.rpyToMatrix(np.array(angles))
            close(R, rodrigues([0, 0, 1], angles[2]) @ rodrigues([0, 1, 0], angles[1]) @ rodrigues([1, 0, 0], angles[0]), 3e-16)
            close(rpy.rpyToMatrix(rpy.matrixToRpy(R)), R, 5e-16)
        close(rpy.matrixToRpy(rpy.rpyToMatrix(0.3, -0.4, 2.0)), [0.3, -0.4, 2.0], 1e-15)

    def test_jacobians_of_roll_pitch_and_yaw_give_the_angular_velocity(self):
        angles, rates, h = np.array([0.3, -0.4, 2.0]), np.array([0.5, 0.7, -0.2]), 1e-6
        for frame in (dyn.LOCAL, dyn.WORLD, dyn.LOCAL_WORLD_ALIGNED):
            R, ahead, behind = (rpy.rpyToMatrix(angles + s * rates) for s in (0, h, -h))
            spin = (ahead - behind) / (2 * h)
            omega = explog.unSkew(R.T @ spin if frame == dyn.LOCAL else spin @ R.T)
            J = rpy.computeRpyJacobian(angles, frame)
            close(J @ rates, omega, 1e-9)
            close(rpy.computeRpyJacobianInverse(angles, frame) @ J, np.eye(3))
            rate = (rpy.computeRpyJacobian(angles + h * rates, frame) - rpy.computeRpyJacobian(angles - h * rates, frame)) / (2 * h)
            close(rpy.computeRpyJacobianTimeDerivative(angles, rates, frame), rate, 1e-9)


if __name__ == "__main__":
    unittest.main()
