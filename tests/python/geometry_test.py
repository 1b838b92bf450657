# SPDX-License-Identifier: BSD-2-Clause
"""Volumes of every kind, collision checks of many states, finders of contacts and SRDF files."""
import pathlib
import tempfile
import unittest

import numpy as np

import libdyn as dyn


def ball():
    model = dyn.Model()
    model.add_body("ball", 0, dyn.JointDescription("free", "free_flyer"), dyn.Inertia(1.0, [0, 0, 0], 0.004 * np.eye(3)))
    model.add_geometry("ball_volume", "ball", dyn.Sphere(0.1))
    return model


def distance_to(shape, height, **options):
    """Returns the distance of a ball at this height to a shape in the world."""
    description = ball()
    description.add_geometry("shape", 0, shape)
    model = dyn.compile(description)
    volumes = dyn.compile_geometry(model, description, **options)
    placed = dyn.GeometryData(volumes)
    q = dyn.neutral(model)
    q[2] = height
    dyn.update_geometry_placements(model, dyn.Data(model), volumes, placed, q)
    return dyn.compute_minimum_distance(volumes, placed).distance


class Files(unittest.TestCase):
    def test_a_saved_model_with_an_embedded_mesh_needs_no_file(self):
        with tempfile.TemporaryDirectory() as folder:
            mesh = pathlib.Path(folder) / "plate.obj"
            mesh.write_text("v -1 -1 0.3\nv 1 -1 0.3\nv 1 1 0.3\nf 1 2 3\n")
            description = ball()
            description.add_geometry("plate", 0, dyn.MeshFile(str(mesh)))
            description.add_geometry("lost", 0, dyn.MeshFile("package://none/a.stl"))
            left = dyn.embed_files(description, largest_file=1000)
            mesh.unlink()
            path = pathlib.Path(folder) / "robot.dyn.json"
            dyn.save(description, path)
            loaded = dyn.load(path)
        self.assertEqual(len(left), 1)
        self.assertIn("'lost' (package://none/a.stl): the file is not there", left[0])
        volumes = dyn.compile_geometry(dyn.compile(loaded), loaded, skip_missing=True)
        self.assertEqual([volume.name for volume in volumes.geometries], ["ball_volume", "plate"])


class Shapes(unittest.TestCase):
    def test_every_shape_has_its_distance(self):
        square = dyn.TriangleMesh([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], [[0, 1, 2], [0, 2, 3]])
        corners = [[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
        for shape, top in (
            (dyn.Sphere(0.5), 0.5),
            (dyn.Box(1, 2, 3), 1.5),
            (dyn.Capsule(0.2, 1.0), 0.7),
            (dyn.Cylinder(0.2, 1.0), 0.5),
            (dyn.Cone(0.2, 1.0), 0.5),
            (dyn.HalfSpace([0, 0, 2], 0.5), 0.25),
            (dyn.ConvexHull(corners), 1.0),
            (square, 0.0),
            (dyn.Voxels([[0, 0, 0], [5, 5, 5]], 0.5), 0.25),
            (dyn.Voxels([[0, 0, 0], [5, 5, 5]], [0.5, 1.0]), 0.25),
            (dyn.height_field(np.full((3, 4), 0.3), -1, -1, 1, 1), 0.3),
        ):
            self.assertAlmostEqual(distance_to(shape, 3.0), 3.0 - top - 0.1, places=9, msg=shape)
        self.assertAlmostEqual(distance_to(dyn.Box(1, 2, 3), 3.0, fcl=True, fcl_tolerance=1e-8), 1.4, places=5)

    def test_shapes_show_and_change_their_numbers(self):
        box, capsule, plane = dyn.Box(1, 2, 3), dyn.Capsule(0.2, 1.0), dyn.HalfSpace()
        np.testing.assert_array_equal(box.size, [1, 2, 3])
        capsule.length = 2.0
        self.assertEqual((capsule.radius, capsule.length), (0.2, 2.0))
        np.testing.assert_array_equal(plane.normal, [0, 0, 1])
        voxels = dyn.Voxels([[0, 0, 0], [5, 5, 5]], 0.5)
        np.testing.assert_array_equal(voxels.sizes, [0.5, 0.5])
        np.testing.assert_array_equal(voxels.centers[1], [5, 5, 5])
        self.assertEqual(dyn.OctreeFile("scan.bt").uri, "scan.bt")
        mesh = dyn.MeshFile("foot.stl", [1, 1, -1], convex=True)
        self.assertTrue(mesh.convex)
        np.testing.assert_array_equal(mesh.scale, [1, 1, -1])
        with self.assertRaisesRegex(dyn.Error, "2 centres and 3 sizes"):
            dyn.Voxels([[0, 0, 0], [5, 5, 5]], [1, 2, 3])
        with self.assertRaisesRegex(dyn.Error, "two rows and columns at least"):
            dyn.height_field([[1.0, 2.0]], 0, 0, 1, 1)

    def test_files_that_do_not_exist_are_errors_with_their_names(self):
        for shape in (dyn.MeshFile("/no/mesh.stl"), dyn.OctreeFile("/no/tree.bt")):
            with self.assertRaisesRegex(dyn.Error, "/no/"):
                distance_to(shape, 1.0)
            self.assertEqual(distance_to(shape, 1.0, skip_missing=True), np.inf)

    def test_descriptions_list_their_volumes(self):
        description = ball()
        description.add_geometry("look", "ball", dyn.Box(1, 1, 1), dyn.SE3.translation(0, 0, 1), role="visual")
        self.assertEqual([(g.name, g.role, g.body) for g in description.geometries], [("ball_volume", "collision", 1), ("look", "visual", 1)])
        self.assertIsInstance(description.geometries[0].shape, dyn.Sphere)
        self.assertEqual((description.find_geometry("ball_volume"), description.find_geometry("look")), (0, -1))
        with self.assertRaisesRegex(dyn.Error, "role is 'x'"):
            description.add_geometry("g", "ball", dyn.Sphere(1), role="x")
        self.assertEqual(len(description.geometries), 2)


class Checks(unittest.TestCase):
    def setUp(self):
        self.description = ball()
        self.description.add_geometry("ground", 0, dyn.HalfSpace())
        self.model = dyn.compile(self.description)
        self.volumes = dyn.compile_geometry(self.model, self.description)

    def test_volumes_and_pairs_are_found_by_name(self):
        volumes, placed = self.volumes, dyn.GeometryData(self.volumes)
        record = volumes.geometries[volumes.geometry_id("ball_volume")]
        self.assertEqual((record.name, record.body, record.joint), ("ball_volume", "ball", 1))
        self.assertEqual((volumes.pair_id("ground", "ball_volume"), volumes.pair_id("ground", "no")), (0, -1))
        q = dyn.neutral(self.model)
        q[2] = 0.05
        dyn.update_geometry_placements(self.model, dyn.Data(self.model), volumes, placed, q)
        np.testing.assert_array_equal(dyn.geometry_placement(volumes, placed, "ball_volume").p, [0, 0, 0.05])
        with self.assertRaisesRegex(dyn.Error, "did you mean 'ground'"):
            dyn.geometry_placement(volumes, placed, "grund")
        with self.assertRaises(dyn.Error):
            dyn.geometry_placement(volumes, placed, 2)
        self.assertTrue(dyn.any_collision(volumes, placed))
        self.assertEqual(dyn.first_collision(placed), 0)

    def test_many_states_are_checked_at_once(self):
        q = np.tile(dyn.neutral(self.model), (7, 1))
        q[:, 2] = np.linspace(0.05, 0.17, 7)
        for threads in (1, 3):
            batch = dyn.GeometryBatch(self.model, self.volumes, 10, threads)
            self.assertEqual(batch.capacity, 10)
            hits = dyn.compute_collisions(self.model, batch, q)
            self.assertEqual(hits.dtype, np.bool_)
            np.testing.assert_array_equal(hits, q[:, 2] <= 0.1)
        with self.assertRaisesRegex(dyn.Error, "11"):
            dyn.compute_collisions(self.model, batch, np.zeros((11, 7)))
        with self.assertRaisesRegex(TypeError, "compute_collisions: q"):
            dyn.compute_collisions(self.model, batch, q[0])

    def test_disabled_pairs_are_left_out(self):
        self.description.disable_collision("ball", "ground", "never")
        self.assertEqual(dyn.compile_geometry(self.model, self.description).pairs, [])
        self.description.disabled_collisions = []
        self.assertEqual(len(dyn.compile_geometry(self.model, self.description).pairs), 1)


class Finders(unittest.TestCase):
    def setUp(self):
        self.description = ball()
        self.description.add_geometry("ground", 0, dyn.HalfSpace())
        self.model = dyn.compile(self.description)
        self.q = dyn.neutral(self.model)
        self.q[2] = 0.3

    def lands(self, finder):
        simulator = dyn.Simulator(self.model, dt=1e-3)
        simulator.reset(self.q, np.zeros(6))
        simulator.set_contacts(finder)
        simulator.advance(1.0)
        return simulator.q[2]

    def test_a_finder_written_in_python_holds_a_ball(self):
        def find(q, reach):
            return [dyn.ContactPoint(0, self.model.frame_id("ball"), [0, 0, -0.1], gap=q[2] - 0.1, friction=0.5)] if q[2] < 0.2 else []

        finder = dyn.ContactFinder(find)
        self.assertFalse(finder.looks_ahead)
        self.assertEqual(finder(self.q), [])
        self.q[2] = 0.15
        (point,) = finder(self.q)
        self.assertAlmostEqual(point.gap, 0.05)
        np.testing.assert_array_equal(point.normal, [0, 0, 1])
        self.assertAlmostEqual(self.lands(finder), 0.1, places=3)

    def test_exceptions_of_a_finder_arrive(self):
        def find(q, reach):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            self.lands(dyn.ContactFinder(find))
        with self.assertRaises((TypeError, RuntimeError)):
            self.lands(dyn.ContactFinder(lambda q, reach: [1]))
        with self.assertRaisesRegex(dyn.Error, "frame 99"):
            self.lands(dyn.ContactFinder(lambda q, reach: [dyn.ContactPoint(0, 99, gap=-0.01)]))

    def test_finders_join_and_check_their_arguments(self):
        volumes = dyn.compile_geometry(self.model, self.description)
        ground = dyn.geometry_contacts(self.model, volumes, pairs=[("ball", "ground", 0.1)])
        plane = dyn.points_on_plane(self.model, ["ball"], height=-1.0)
        both = dyn.together(ground, plane)
        self.assertTrue(both.looks_ahead)
        self.q[2] = 0.1
        self.assertEqual(len(both(self.q, 10.0)), 2)
        self.assertEqual(ground(self.q)[0].friction, 0.1)
        for finder in (ground, plane, both):
            with self.assertRaises(dyn.Error):
                finder([0.0])
        with self.assertRaises(dyn.Error):
            dyn.geometry_contacts(self.model, volumes, friction=-1)
        with self.assertRaisesRegex(dyn.Error, "did you mean 'ball'"):
            dyn.points_on_plane(self.model, ["bal"])


class Srdf(unittest.TestCase):
    def test_pairs_are_written_and_read(self):
        description = ball()
        pairs = [dyn.DisabledCollision("ball", "universe", "Adjacent")]
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "ball.srdf"
            dyn.srdf.write(path, "robot", pairs)
            self.assertEqual(path.read_text(), dyn.srdf.text("robot", pairs))
            dyn.srdf.load(path, description)
        (pair,) = description.disabled_collisions
        self.assertEqual((pair.body, pair.other, pair.reason), ("ball", "universe", "Adjacent"))
        with self.assertRaisesRegex(dyn.Error, "bad.srdf") as caught:
            dyn.srdf.parse("<robot", "bad.srdf", description)
        self.assertEqual(caught.exception.code, "syntax")


if __name__ == "__main__":
    unittest.main()
