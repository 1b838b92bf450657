# SPDX-License-Identifier: BSD-2-Clause
"""Lists of one type, Lie groups, serialization and small helpers under the names of Pinocchio."""
import contextlib
import copy
import io
import math
import pathlib
import pickle
import tempfile
import unittest

import numpy as np

import libdyn as dyn
from libdyn.pinocchio import _random, hppfcl, liegroups, linalg, serialization, utils
from libdyn.pinocchio.containers import StdMap_String_VectorXd, StdVec_Bool, StdVec_Force, StdVec_SE3, StdVec_StdString, StdVec_Vector3
from libdyn.pinocchio.geometry import CollisionPair, GeometryModel, GeometryObject, GeometryPhongMaterial
from libdyn.pinocchio.spatial import SE3, Force, Motion

ARG0, ARG1 = dyn.ArgumentPosition.ARG0, dyn.ArgumentPosition.ARG1


class Lists(unittest.TestCase):
    def test_a_list_converts_or_refuses_elements(self):
        forces = StdVec_Force([Force.Zero(), dyn.Force([1, 2, 3])])
        self.assertTrue(all(type(f) is Force for f in forces))
        forces.extend([Force.Random()])
        forces[0] = dyn.Force([4, 5, 6])
        self.assertIs(type(forces[0]), Force)
        for wrong in (Motion.Zero(), 3, None):
            with self.assertRaisesRegex(TypeError, "an element must be a Force"):
                forces.append(wrong)
        with self.assertRaises(ValueError):
            StdVec_Vector3([[1, 2]])
        with self.assertRaises(TypeError):
            StdVec_StdString([1])
        self.assertIs(type(forces[1:]), StdVec_Force)
        for size, error in ((-1, ValueError), (2**70, (OverflowError, MemoryError)), (2**62, (OverflowError, MemoryError)), (1.5, TypeError)):
            with self.assertRaises(error):
                StdVec_Force(size, Force.Zero())

    def test_elements_are_the_objects_themselves_and_copies_are_not(self):
        poses = StdVec_SE3(2, SE3.Identity())
        poses[0].translation[0] = 1.0
        self.assertEqual((poses[0].translation[0], poses[1].translation[0]), (1.0, 0.0))
        for other in (poses.copy(), copy.copy(poses), copy.deepcopy(poses), pickle.loads(pickle.dumps(poses)), StdVec_SE3(poses.tolist(True))):
            self.assertEqual(other, poses)
            other[0].translation[0] = 2.0
            self.assertEqual(poses[0].translation[0], 1.0)
        self.assertIs(poses.tolist()[0], poses[0])
        self.assertNotEqual(poses, StdVec_SE3())
        self.assertEqual(StdVec_Bool(3, True), [True] * 3)

    def test_a_map_keeps_vectors_by_name(self):
        references = StdMap_String_VectorXd(half_sitting=[1, 2])
        references["zero"] = np.zeros(3)
        other = pickle.loads(pickle.dumps(references))
        np.testing.assert_array_equal(other["half_sitting"], [1.0, 2.0])
        self.assertEqual(list(other), ["half_sitting", "zero"])
        with self.assertRaises(TypeError):
            references[3] = [1]


class LieGroups(unittest.TestCase):
    def setUp(self):
        _random.seed(11)
        self.groups = [liegroups.Rn(4), liegroups.SO2(), liegroups.SO3(), liegroups.SE2(), liegroups.SE3()]
        self.groups.append(liegroups.R3() * liegroups.SO3() * liegroups.SE2())

    def test_names_and_sizes_are_those_of_pinocchio(self):
        product = liegroups.R3() * liegroups.SO3()
        self.assertEqual((product.name, product.nq, product.nv), ("R^3 x SO(3)", 7, 6))
        self.assertEqual([g.name for g in self.groups[:5]], ["R^4", "SO(2)", "SO(3)", "SE(2)", "SE(3)"])
        self.assertEqual(product, liegroups.R3() * liegroups.SO3())
        np.testing.assert_array_equal(product.neutral, [0, 0, 0, 0, 0, 0, 1])

    def test_differences_undo_integration(self):
        for g in self.groups:
            q, v = g.random(), _random.uniform(g.nv)
            np.testing.assert_allclose(g.difference(q, g.integrate(q, v)), v, atol=1e-14)
            np.testing.assert_allclose(g.interpolate(q, g.integrate(q, v), 0.5), g.integrate(q, v / 2), atol=1e-14)
            self.assertAlmostEqual(g.distance(q, g.integrate(q, v)), np.linalg.norm(v))
            np.testing.assert_allclose(g.normalize(2 * q)[g.nq - 1], q[g.nq - 1] * (2 if g.name == "R^4" else 1))

    def test_derivatives_are_those_of_the_functions(self):
        h = 1e-6
        for g in self.groups:
            q, v = g.random(), _random.uniform(g.nv)
            end = g.integrate(q, v)
            for e, by_q, by_v in zip(np.eye(g.nv), g.dIntegrate_dq(q, v).T, g.dIntegrate_dv(q, v).T):
                moved = [g.difference(end, g.integrate(g.integrate(q, s * e), v)) for s in (h, -h)]
                np.testing.assert_allclose(by_q, (moved[0] - moved[1]) / (2 * h), atol=1e-8)
                moved = [g.difference(end, g.integrate(q, v + s * e)) for s in (h, -h)]
                np.testing.assert_allclose(by_v, (moved[0] - moved[1]) / (2 * h), atol=1e-8)
            for arg, ends in ((ARG0, lambda d: (g.integrate(q, d), end)), (ARG1, lambda d: (q, g.integrate(end, d)))):
                J = g.dDifference(q, end, arg)
                for e, column in zip(np.eye(g.nv), J.T):
                    np.testing.assert_allclose(column, (g.difference(*ends(h * e)) - g.difference(*ends(-h * e))) / (2 * h), atol=1e-8)

    def test_products_with_a_derivative_take_its_place_as_an_integer(self):
        g = self.groups[4]
        q, v, A = g.random(), _random.uniform(6), _random.uniform(6, 6)
        J = g.dIntegrate_dq(q, v)
        np.testing.assert_allclose(g.dIntegrate_dq(q, v, 0, A), J @ A)
        np.testing.assert_allclose(g.dIntegrate_dq(q, v, A, 0), A @ J)
        np.testing.assert_allclose(g.dIntegrateTransport(q, v, A, ARG0), J @ A)
        with self.assertRaises(TypeError):
            g.dIntegrate_dq(q, v, A, A)

    def test_random_configurations_lie_within_limits(self):
        g = liegroups.SE3()
        lower, upper = np.array([1.0, 2, 3, -1, -1, -1, -1]), np.array([2.0, 3, 4, 1, 1, 1, 1])
        for _ in range(20):
            q = g.randomConfiguration(lower, upper)
            self.assertTrue(np.all((lower <= q) & (q <= upper)))
        with self.assertRaisesRegex(ValueError, "not finite"):
            liegroups.R1().randomConfiguration([0], [np.inf])
        with self.assertRaisesRegex(ValueError, "q has shape"):
            g.integrate(np.zeros(6), np.zeros(6))


def volumes():
    model = GeometryModel()
    look = {"mesh_color": [1, 0, 0, 1], "mesh_material": GeometryPhongMaterial()}
    model.addGeometryObject(GeometryObject("ball", 1, 2, SE3.Random(), hppfcl.Sphere(0.1), **look))
    model.addGeometryObject(GeometryObject("hull", 2, SE3.Random(), hppfcl.Convex(np.eye(3))))
    model.addGeometryObject(GeometryObject("mesh", 3, SE3.Random(), hppfcl.BVHModelOBBRSS(np.eye(3), [[0, 1, 2]])))
    model.addCollisionPair(CollisionPair(0, 1))
    return model


class Serialization(unittest.TestCase):
    def setUp(self):
        _random.seed(1)
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = pathlib.Path(self.folder.name)

    def test_every_form_keeps_all_digits(self):
        model = volumes()
        model.geometryObjects[0].meshScale = np.array([np.inf, np.nextafter(1, 2), 5e-324])
        for write, read in (
            (lambda: model.saveToText(self.path / "a.txt"), lambda x: x.loadFromText(self.path / "a.txt")),
            (lambda: model.saveToXML(self.path / "a.xml", "Model"), lambda x: x.loadFromXML(self.path / "a.xml", "Model")),
            (lambda: model.saveToBinary(self.path / "a.bin"), lambda x: x.loadFromBinary(self.path / "a.bin")),
        ):
            other = GeometryModel()
            write()
            read(other)
            self.assertEqual(other, model)
        other.loadFromString(model.saveToString())
        self.assertEqual(other, model)
        buffer = serialization.StreamBuffer()
        model.saveToBinary(buffer)
        other = GeometryModel()
        other.loadFromBinary(buffer)
        self.assertEqual(other, model)
        self.assertEqual(pickle.loads(pickle.dumps(model)), model)

    def test_lists_of_spatial_quantities_are_written_too(self):
        poses, other = StdVec_SE3([SE3.Random(), SE3.Random()]), StdVec_SE3()
        serialization.saveToText(poses, self.path / "poses.txt")
        serialization.loadFromText(other, self.path / "poses.txt")
        self.assertEqual(other, poses)

    def test_malformed_files_are_refused(self):
        model = GeometryModel()
        for text in ("", "{", "[1]", '{"class": "os.system", "arguments": ["true"]}', '{"class": "libdyn.os.system", "arguments": ["true"]}',
                     '{"class": "libdyn.pinocchio.geometry.CollisionPair", "arguments": [1, 2]}', "3", "[" * 100000):  # fmt: skip
            (self.path / "x.txt").write_text(text)
            with self.assertRaises(ValueError, msg=text[:50]):
                model.loadFromText(self.path / "x.txt")
        (self.path / "x.xml").write_text("<a/>")
        with self.assertRaisesRegex(ValueError, "<a>"):
            model.loadFromXML(self.path / "x.xml", "Model")
        with self.assertRaises(ValueError):
            model.loadFromBinary(b"nothing")
        with self.assertRaises(OSError):
            model.loadFromText(self.path / "absent.txt")


class Helpers(unittest.TestCase):
    def test_small_helpers(self):
        self.assertEqual(utils.npToTuple(np.arange(4).reshape(2, 2)), ((0, 1), (2, 3)))
        self.assertEqual(utils.npToTuple(np.arange(3).reshape(3, 1)), (0, 1, 2))
        self.assertTrue(utils.isapprox(SE3.Identity(), SE3.Identity()))
        self.assertFalse(utils.isapprox(Motion.Zero(), Motion.Random()))
        self.assertEqual(utils.fromListToVectorOfString(["a", "b"]), ["a", "b"])
        self.assertEqual((utils.zero(3).shape, utils.rand([2, 3]).shape, utils.eye(2).trace()), ((3,), (2, 3), 2.0))
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            utils.mprint(SE3.Identity(), "M")
        self.assertIn("Columns 0 through 3", out.getvalue())

    def test_the_largest_eigenvalue_is_that_of_the_matrix(self):
        A = np.diag([1.0, 3.0, 2.0])
        v = linalg.computeLargestEigenvector(A)
        self.assertAlmostEqual(linalg.retrieveLargestEigenvalue(v), 3.0)
        np.testing.assert_allclose(A @ v, 3.0 * v)
        np.testing.assert_allclose(linalg.inv(A) @ A, np.eye(3))

    def test_the_same_seed_gives_the_same_numbers(self):
        _random.seed(3)
        first = SE3.Random()
        _random.seed(3)
        self.assertEqual(SE3.Random(), first)
        self.assertFalse(math.isclose(SE3.Random().translation[0], first.translation[0]))


if __name__ == "__main__":
    unittest.main()
