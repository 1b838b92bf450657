# SPDX-License-Identifier: BSD-2-Clause
"""Volumes, collision and distance under the names of Pinocchio."""
import unittest

import numpy as np

from libdyn.pinocchio import _random, hppfcl
from libdyn.pinocchio.collision import computeCollision, computeCollisions, computeDistance, computeDistances
from libdyn.pinocchio.geometry import (
    CollisionPair,
    GeometryData,
    GeometryModel,
    GeometryNoMaterial,
    GeometryObject,
    GeometryPhongMaterial,
)
from libdyn.pinocchio.spatial import SE3


def at(x, y=0.0, z=0.0):
    return SE3(np.eye(3), np.array([x, y, z], dtype=float))


def spheres(count, radius=0.1):
    """Returns balls on joints 1, 2, ... and all their pairs."""
    model = GeometryModel()
    for k in range(count):
        model.addGeometryObject(GeometryObject(f"ball {k}", k + 1, SE3.Identity(), hppfcl.Sphere(radius)))
    model.addAllCollisionPairs()
    return model


class Checks(unittest.TestCase):
    def setUp(self):
        _random.seed(2)

    def test_distances_have_points_and_normals_in_the_world(self):
        model = spheres(2)
        data = model.createData()
        data.oMg[0], data.oMg[1] = at(1), at(1, 2)
        for pair, sign in ((CollisionPair(0, 1), 1.0), (CollisionPair(1, 0), -1.0)):
            model.collisionPairs[0] = pair
            result = computeDistance(model, data, 0)
            self.assertIs(result, data.distanceResults[0])
            self.assertAlmostEqual(result.min_distance, 1.8)
            np.testing.assert_allclose(result.normal, [0, sign, 0], atol=1e-15)
            first, second = ([1, 0.1, 0], [1, 1.9, 0]) if sign > 0 else ([1, 1.9, 0], [1, 0.1, 0])
            np.testing.assert_allclose(result.getNearestPoint1(), first, atol=1e-15)
            np.testing.assert_allclose(result.getNearestPoint2(), second, atol=1e-15)

    def test_shapes_are_measured_as_their_sizes_say(self):
        ball = hppfcl.Sphere(0.5)
        for shape, distance in (
            (hppfcl.Box(1, 2, 3), 2.0),
            (hppfcl.Capsule(0.25, 1), 2.25),
            (hppfcl.Cylinder(0.25, 1), 2.25),
            (hppfcl.Cone(0.5, 1e-3), 2.0),
            (hppfcl.Halfspace([2.0, 0, 0], 2.0), 1.5),
            (hppfcl.Convex([[1, -1, -1], [1, 1, -1], [1, 0, 1], [-1, 0, 0]]), 1.5),
            (hppfcl.BVHModelOBBRSS([[1, -1, -1], [1, 1, -1], [1, 0, 1]], [[0, 1, 2]]), 1.5),
        ):
            result = hppfcl.DistanceResult()
            out = hppfcl.distance(shape, SE3.Identity(), ball, hppfcl.Transform3f(at(3)), hppfcl.DistanceRequest(), result)
            self.assertAlmostEqual(out, distance, delta=1e-3 if isinstance(shape, hppfcl.Cone) else 1e-9, msg=repr(shape))
            M = SE3.Random()
            self.assertAlmostEqual(hppfcl.distance(shape, M, ball, M * at(3), hppfcl.DistanceRequest(), result), out, places=9)
            self.assertEqual(shape.clone(), shape)
            self.assertNotEqual(shape, ball)

    def test_only_active_pairs_of_volumes_that_may_collide_are_checked(self):
        model = spheres(3)
        data = model.createData()
        data.oMg[1], data.oMg[2] = at(0.15), at(5)
        self.assertTrue(computeCollisions(model, data))
        self.assertEqual([r.isCollision() for r in data.collisionResults], [True, False, False])
        self.assertEqual(computeDistances(model, data), 0)
        self.assertAlmostEqual(data.distanceResults[0].min_distance, -0.05)
        data.deactivateCollisionPair(0)
        self.assertFalse(computeCollisions(model, data))
        self.assertEqual(computeDistances(model, data), 2)
        data.activateCollisionPair(0)
        self.assertTrue(computeCollisions(model, data, True))
        model.geometryObjects[0].disableCollision = True
        self.assertFalse(computeCollisions(model, data))
        self.assertFalse(computeCollision(model, data, 0))
        with self.assertRaisesRegex(ValueError, "there are 3 pairs"):
            computeCollision(model, data, 3)
        with self.assertRaisesRegex(TypeError, "geometry_data must be a GeometryData"):
            computeCollisions(model, model)
        with self.assertRaisesRegex(TypeError, "give geometry_model"):
            computeDistances()

    def test_margins_and_contacts_follow_the_request(self):
        model = spheres(2)
        data = model.createData()
        data.oMg[1] = at(0.25)
        self.assertFalse(computeCollision(model, data, 0))
        data.setSecurityMargins(model, np.full((2, 2), 0.06))
        self.assertTrue(computeCollision(model, data, 0))
        data.setSecurityMargins(model, np.zeros((2, 2)))
        data.oMg[1] = at(0.15)
        request = data.collisionRequests[0]
        request.enable_contact = True
        self.assertTrue(computeCollision(model, data, 0))
        contact = data.collisionResults[0].getContact(0)
        self.assertAlmostEqual(contact.penetration_depth, -0.05)
        np.testing.assert_allclose(contact.pos, [0.075, 0, 0], atol=1e-15)
        np.testing.assert_allclose(contact.normal, [1, 0, 0], atol=1e-15)
        np.testing.assert_allclose(contact.getNearestPoint1() - contact.getNearestPoint2(), [0.05, 0, 0], atol=1e-15)

    def test_a_change_of_shapes_or_pairs_is_seen(self):
        model = spheres(3)
        data = model.createData()
        data.oMg[1], data.oMg[2] = at(1), at(3)
        self.assertAlmostEqual(computeDistance(model, data, 0).min_distance, 0.8)
        model.geometryObjects[0].geometry.radius = 0.3
        self.assertAlmostEqual(computeDistance(model, data, 0).min_distance, 0.6)
        model.geometryObjects[0].geometry = hppfcl.Box(0.2, 0.2, 0.2)
        self.assertAlmostEqual(computeDistance(model, data, 0).min_distance, 0.8)
        model.removeGeometryObject("ball 1")
        data = model.createData()
        data.oMg[1] = at(3)
        self.assertAlmostEqual(computeDistance(model, data, 0).min_distance, 2.8)

    def test_shapes_that_libdyn_does_not_compare_say_so(self):
        model = GeometryModel()
        model.addGeometryObject(GeometryObject("a", 1, SE3.Identity(), hppfcl.Ellipsoid(1, 2, 3)))
        model.addGeometryObject(GeometryObject("b", 2, SE3.Identity(), hppfcl.Sphere(1)))
        model.addAllCollisionPairs()
        with self.assertRaisesRegex(NotImplementedError, "Ellipsoid"):
            computeCollision(model, model.createData(), 0)


class Models(unittest.TestCase):
    def test_pairs_are_added_found_and_removed(self):
        model = spheres(3)
        self.assertEqual(model.collisionPairMapping.tolist(), [[-1, 0, 1], [0, -1, 2], [1, 2, -1]])
        self.assertEqual(model.findCollisionPair(CollisionPair(1, 2)), 2)
        model.removeCollisionPair(CollisionPair(0, 2))
        self.assertFalse(model.existCollisionPair(CollisionPair(0, 2)))
        model.addCollisionPair(CollisionPair(0, 2))
        model.addCollisionPair(CollisionPair(0, 2))
        self.assertEqual(len(model.collisionPairs), 3)
        model.setCollisionPairs(np.array([[0, 1, 0], [0, 0, 0], [1, 0, 0]]))
        self.assertEqual(model.collisionPairs, [CollisionPair(0, 1)])
        model.setCollisionPairs(np.array([[0, 1, 0], [0, 0, 0], [1, 0, 0]]), False)
        self.assertEqual(model.collisionPairs, [CollisionPair(0, 2)])
        for wrong in (lambda: CollisionPair(1, 1), lambda: model.addCollisionPair(CollisionPair(0, 3)), lambda: model.removeGeometryObject("x")):
            with self.assertRaises(ValueError):
                wrong()
        model.geometryObjects[1].parentJoint = 1
        model.addAllCollisionPairs()
        self.assertEqual(len(model.collisionPairs), 2)

    def test_names_lead_to_volumes(self):
        model = spheres(2)
        self.assertEqual((model.ngeoms, model.getGeometryId("ball 1"), model.getGeometryId("x")), (2, 1, 2))
        self.assertTrue(model.existGeometryName("ball 0"))
        model.removeGeometryObject("ball 0")
        self.assertEqual((model.ngeoms, len(model.collisionPairs)), (1, 0))

    def test_copies_share_nothing(self):
        model = spheres(2)
        other = model.copy()
        self.assertEqual(other, model)
        other.geometryObjects[0].placement.translation[0] = 1
        other.geometryObjects[0].geometry.radius = 7
        self.assertEqual((model.geometryObjects[0].placement, model.geometryObjects[0].geometry.radius), (SE3.Identity(), 0.1))
        data = model.createData()
        copied = data.copy()
        copied.oMg[0].translation[0] = 3
        self.assertEqual(data.oMg[0], SE3.Identity())
        self.assertIsInstance(copied, GeometryData)

    def test_all_forms_of_the_constructor_mean_the_same(self):
        M, ball = SE3.Random(), hppfcl.Sphere(1)
        expected = GeometryObject("x", 1, 2, M, ball, "path", np.array([1.0, 2, 3]), True, np.zeros(4), "texture")
        self.assertEqual((expected.parentJoint, expected.parentFrame, expected.meshPath, expected.overrideMaterial), (1, 2, "path", True))
        for other in (
            GeometryObject("x", 2, 1, ball, M, "path", np.array([1.0, 2, 3]), True, np.zeros(4), "texture"),
            GeometryObject(name="x", parent_joint=1, parent_frame=2, placement=M, collision_geometry=ball, mesh_path="path", mesh_scale=[1, 2, 3],
                           override_material=True, mesh_color=[0, 0, 0, 0], mesh_texture_path="texture"),  # fmt: skip
            GeometryObject(expected),
            expected.copy(),
        ):
            self.assertEqual(other, expected)
        self.assertEqual(GeometryObject("y", 1, M, ball).parentFrame, GeometryObject("y", 1, ball, M).parentFrame)
        for wrong in (lambda: GeometryObject("x", 1, M), lambda: GeometryObject("x", 1, M, ball, colour=1)):
            with self.assertRaises(TypeError):
                wrong()

    def test_materials_are_kept_by_reference(self):
        volume = GeometryObject.CreateCapsule(0.1, 0.4)
        self.assertIsInstance(volume.meshMaterial, GeometryNoMaterial)
        volume.meshMaterial = GeometryPhongMaterial()
        material = volume.meshMaterial
        material.meshShininess = 0.7
        self.assertEqual(volume.meshMaterial.meshShininess, 0.7)


if __name__ == "__main__":
    unittest.main()
