# SPDX-License-Identifier: BSD-2-Clause
"""Joint types written in Python compute what the same types in C++ do, and refuse what cannot be traced."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

import libdyn as dyn

os.environ.setdefault("LIBDYN_CACHE", tempfile.mkdtemp(prefix="libdyn-joint-types-"))


def turning(axis):
    """A joint that turns about an axis, as the standard type revolute."""

    @dyn.joint(nq=1)
    def python_revolute(q, p):
        return dyn.SE3.rotation(axis, q[0])

    return python_revolute


@dyn.joint(nq=1, parameters={"h": "m"})
def python_cam(q, p):
    """A follower on an eccentric cam."""
    return dyn.SE3.translation(0, 0, p.h * (1 - dyn.cos(q[0])))


def point(q, p):
    """z axis along the unit vector q, as the example plugin `direction`."""
    n = q / dyn.sqrt(q @ q)
    k = 1 / (1 + n[2])
    R = [[1 - k * n[0] * n[0], -k * n[0] * n[1], n[0]], [-k * n[0] * n[1], 1 - k * n[1] * n[1], n[1]], [-n[0], -n[1], n[2]]]
    return R, [0, 0, 0]


def axes(n):
    return np.asarray(point(n, None)[0], dtype=object)


def move(q, v, p):
    angle = dyn.sqrt(v[0] * v[0] + v[1] * v[1])
    share = dyn.select(0 < angle, dyn.sin(angle) / angle, 1)
    n = axes(q) @ np.array([share * v[1], -share * v[0], dyn.cos(angle)], dtype=object)
    return n / dyn.sqrt(n @ n)


def way(q0, q1, p):
    d = axes(q0).T @ (q1 - q0)
    sine = dyn.sqrt(d[0] * d[0] + d[1] * d[1])
    share = dyn.select(0 < sine, dyn.atan2(sine, 1 + d[2]) / sine, 1)
    return [-share * d[1], share * d[0]]


SPACE = {"neutral": lambda p: [0, 0, 1], "integrate": move, "difference": way, "normalize": lambda q, p: q / dyn.sqrt(q @ q)}


def arm(type, parameters=None, n=3, nv=1):
    """A chain of n joints of a type with nv degrees of freedom."""
    model = dyn.Model()
    for k in range(n):
        joint = dyn.JointDescription(f"j{k}", type, parameters or {}, dyn.SE3.translation(0.1, 0.2, 0.3))
        joint.armature = [0.01] * nv
        model.add_body(f"b{k}", k, joint, dyn.Inertia(1.0 + k, [0.1, -0.2, 0.3], np.diag([0.3, 0.2, 0.4])))
    return dyn.compile(model)


def results(model, seed=0):
    """Everything that the pose map influences, at a random state."""
    data = dyn.Data(model)
    q = dyn.random_configuration(model, seed)
    rng = np.random.default_rng(seed)
    v, a = rng.uniform(-1, 1, (2, model.nv))
    out = [dyn.rnea(model, data, q, v, a), dyn.crba(model, data, q), dyn.aba(model, data, q, v, a)]
    out += dyn.compute_rnea_derivatives(model, data, q, v, a)
    out += dyn.compute_aba_derivatives(model, data, q, v, a)
    out += [dyn.d_integrate(model, q, v, by) for by in (dyn.ArgumentPosition.ARG0, dyn.ArgumentPosition.ARG1)]
    return [np.array(x) for x in out]


class JointTypes(unittest.TestCase):
    def close(self, a, b, tolerance=1e-12):
        for k, (x, y) in enumerate(zip(a, b)):
            self.assertLess(np.max(np.abs(x - y)) / max(1, np.max(np.abs(y))), tolerance, k)

    def test_a_revolute_joint_in_python_computes_what_the_standard_type_does(self):
        axis = np.array([0.6, 0, 0.8])
        joint = turning(axis)
        self.close(results(arm(joint.name)), results(arm("revolute", {"axis": list(axis)})))

    def test_a_batch_of_states_computes_what_single_calls_do(self):
        model = arm("python_cam", {"h": 0.3})
        batch, data = dyn.BatchData(model, 17), dyn.Data(model)
        rng = np.random.default_rng(1)
        q, v, a = rng.uniform(-3, 3, (3, 17, model.nv))
        tau = dyn.rnea(model, batch, q, v, a)
        for k in range(17):
            self.close([tau[k]], [dyn.rnea(model, data, q[k], v[k], a[k])])

    def test_every_function_works_in_packs_and_under_differentiation(self):
        @dyn.joint(nq=2)
        def every_function(q, p):
            x = dyn.tan(0.1 * q[0]) + dyn.exp(0.1 * q[1]) + dyn.log(2 + q[0] ** 2) + dyn.atan2(q[0], 2 + q[1] ** 2)
            y = abs(q[0] - 10) ** 0.5 + dyn.select(q[0] < q[1], 0.1 * q[0], 0.1 * q[1]) - q[1] ** -2 / (1 + q[0] ** 2)
            return dyn.SE3.translation(x, y, x * y) @ dyn.SE3.rotation([0.1 * x, 0.2 * y, q[0]])

        model = arm(every_function.name, n=2, nv=2)
        batch, data = dyn.BatchData(model, 9), dyn.Data(model)
        q, v, a = np.random.default_rng(2).uniform(0.2, 1, (3, 9, model.nv))
        together, single = dyn.rnea(model, batch, q, v, a), []
        for k in range(9):
            single.append(dyn.rnea(model, data, q[k], v[k], a[k]))
        self.close(together, single)
        derivative = np.array(dyn.compute_rnea_derivatives(model, data, q[0], v[0], a[0])[0])
        h = 1e-6
        for k in range(model.nv):
            step = h * np.eye(model.nv)[k]
            difference = (dyn.rnea(model, data, q[0] + step, v[0], a[0]) - dyn.rnea(model, data, q[0] - step, v[0], a[0])) / (2 * h)
            self.close([derivative[:, k]], [difference], 1e-6)

    def test_a_configuration_space_of_its_own_has_consistent_functions(self):
        joint = dyn.joint(nq=3, nv=2, **SPACE)(point)
        model = arm(joint.name, n=2, nv=2)
        q = dyn.random_configuration(model, 3)
        self.assertTrue(dyn.is_normalized(model, q))
        v = np.array([0.3, -0.2, 0.5, 0.1])
        np.testing.assert_allclose(dyn.difference(model, q, dyn.integrate(model, q, v)), v, atol=1e-13)
        self.assertLess(np.max(np.abs(dyn.difference(model, q, q))), 1e-15)
        here = dyn.d_integrate(model, q, v, dyn.ArgumentPosition.ARG1)
        h = 1e-6
        for k in range(model.nv):
            step = h * np.eye(model.nv)[k]
            end, less, more = (dyn.integrate(model, q, v + x) for x in (0, -step, step))
            change = (dyn.difference(model, end, more) - dyn.difference(model, end, less)) / (2 * h)
            np.testing.assert_allclose(here[:, k], change, atol=1e-8)

    def test_the_graph_itself_computes_what_the_plugin_does(self):
        compiled = results(arm(dyn.joint(nq=3, nv=2, **SPACE)(point).name, n=2, nv=2))
        joint = dyn.joint(nq=3, nv=2, compiled=False, **SPACE)(point)
        self.assertIsNone(joint.path)
        self.close(results(arm(joint.name, n=2, nv=2)), compiled)

    def test_parameters_have_sizes_and_usual_values(self):
        knots = dyn.Parameter("m", size=5, help="heights", usual=[1, 2, 3, 4, 5])

        @dyn.joint(nq=1, parameters={"knots": knots, "axis": dyn.Parameter(size=3)})
        def listed(q, p):
            return dyn.SE3.translation(*(p.axis * (p.knots @ np.array([q[0] ** k for k in range(5)]))))

        model = arm("listed", {"axis": [1, 0, 0]}, n=1)
        data = dyn.Data(model)
        dyn.forward_kinematics(model, data, [2.0])
        expected = 0.1 + np.polyval([5, 4, 3, 2, 1], 2.0)
        self.assertAlmostEqual(dyn.joint_placement(model, data, 1).p[0], expected, delta=1e-12)
        self.assertAlmostEqual(listed([2.0], axis=[1, 0, 0]).p[0], expected - 0.1, delta=1e-12)
        with self.assertRaisesRegex(dyn.Error, "knots must have 5 numbers"):
            arm("listed", {"axis": [1, 0, 0], "knots": [1, 2]})

    def test_a_new_definition_replaces_the_old_one_and_compiled_models_keep_theirs(self):
        def define(length):
            @dyn.joint(nq=1)
            def redefined(q, p):
                return dyn.SE3.translation(0, 0, length * q[0])

            return arm("redefined", n=1)

        before, after = define(1.0), define(2.0)
        heights = []
        for model in (before, after):
            data = dyn.Data(model)
            dyn.forward_kinematics(model, data, [1.0])
            heights.append(dyn.joint_placement(model, data, 1).p[2])
        np.testing.assert_allclose(heights, [1.3, 2.3])

    def test_a_name_of_a_standard_type_is_refused(self):
        with self.assertRaisesRegex(dyn.Error, "already provided"):

            @dyn.joint(nq=1)
            def revolute(q, p):
                return dyn.SE3()

    def test_decisions_by_traced_numbers_are_refused_with_the_line(self):
        def decides(q, p):
            if q[0] < 0:  # this line
                return dyn.SE3()
            return dyn.SE3.translation(0, 0, q[0])

        with self.assertRaises(dyn.Error) as caught:
            dyn.joint(nq=1)(decides)
        self.assertEqual(caught.exception.file, __file__)
        self.assertEqual(caught.exception.line, decides.__code__.co_firstlineno + 1)
        self.assertIn("libdyn.select", str(caught.exception))
        import math

        for function in (lambda q, p: dyn.SE3.translation(0, 0, math.sin(q[0])), lambda q, p: dyn.SE3.translation(0, 0, q[0] % 2)):
            with self.assertRaisesRegex(dyn.Error, "libdyn.sin"):
                dyn.joint(nq=1)(function)

    def test_wrong_definitions_are_refused_by_name(self):
        def pose(q, p):
            return dyn.SE3.translation(0, 0, q[0])

        incomplete = {"nq": 3, "neutral": lambda p: []}
        for message, arguments in (("nv must be 1 to 6", {"nq": 9}), ("more coordinates", {"nq": 3, "nv": 2}), ("no difference", incomplete)):
            with self.assertRaisesRegex(dyn.Error, message, msg=message):
                dyn.joint(**arguments)(pose)
        with self.assertRaisesRegex(TypeError, "SE3"):
            dyn.joint(nq=1)(lambda q, p: q)
        with self.assertRaisesRegex(dyn.Error, "cannot name a joint type"):
            dyn.joint(nq=1)(lambda q, p: dyn.SE3.translation(0, 0, q[0]))

    def test_without_a_compiler_the_error_names_the_slower_way(self):
        code = (
            "import libdyn as dyn\n"
            "def alone(q, p): return dyn.SE3.translation(0, q[0], 7)\n"
            "try: dyn.joint(nq=1)(alone)\n"
            "except dyn.Error as e: print(e.code, 'compiled=False' in str(e))\n"
        )
        done = subprocess.run([sys.executable, "-c", code], env={**os.environ, "CXX": "/nowhere/c++"}, capture_output=True, text=True)
        self.assertEqual(done.stdout, "compiler True\n", done.stderr)

    def test_the_source_is_an_authors_and_the_folder_builds(self):
        source = dyn.joint.source(python_cam)
        for part in ("struct PythonCamJoint", 'name = "python_cam"', "A follower on an eccentric cam.", "DYN_EXPORT_JOINTS(PythonCamJoint)"):
            self.assertIn(part, source)
        with tempfile.TemporaryDirectory() as folder:
            written = dyn.joint.export_plugin(python_cam, pathlib.Path(folder) / "cam")
            self.assertEqual(sorted(path.name for path in written.iterdir()), ["CMakeLists.txt", "README.md", "python_cam.cpp", "python_cam.urdf"])
            model = dyn.compile(dyn.load(written / "python_cam.urdf"))
            self.assertEqual(model.joints[1].type, "python_cam")
            with self.assertRaises(FileExistsError):
                dyn.joint.export_plugin(python_cam, written)

    def test_another_process_knows_the_type_when_it_imports_the_definition(self):
        code = "import joint_types_test as t; print(*t.results(t.arm('python_cam', {'h': 0.3}))[0])"
        folder = pathlib.Path(__file__).parent
        done = subprocess.run([sys.executable, "-B", "-c", code], cwd=folder, capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.close([np.array(done.stdout.split(), dtype=float)], results(arm("python_cam", {"h": 0.3}))[:1])


class ModelFiles(unittest.TestCase):
    def test_a_python_file_leaves_a_model(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "robot.py"
            path.write_text("import libdyn\nmodel = libdyn.Model()\nmodel.name = 'made'\n")
            self.assertEqual(dyn.load(path).name, "made")
            path.write_text("model = 1\n")
            with self.assertRaisesRegex(dyn.Error, "robot.py: must leave a libdyn.Model called `model`; it leaves int"):
                dyn.load(path)

    def test_a_model_is_saved_loaded_and_pickled_without_loss(self):
        import pickle

        model = dyn.Model()
        model.add_body("a", 0, dyn.JointDescription("j", "revolute", {"axis": [0, 0.6, 0.8]}), dyn.Inertia(1 / 3, [0.1, 0, 0], np.eye(3)))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "a.dyn.json"
            dyn.save(model, path)
            self.assertEqual(dyn.load(path).to_json(), model.to_json())
        self.assertEqual(pickle.loads(pickle.dumps(model)).to_json(), model.to_json())


if __name__ == "__main__":
    unittest.main()
