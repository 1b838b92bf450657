# SPDX-License-Identifier: BSD-2-Clause
"""Graphs, their derivatives and generated code agree with the algorithms."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import libdyn as dyn

ARM = pathlib.Path(__file__).parents[2] / "models" / "arm.urdf"


class Generated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.model = dyn.compile(dyn.load(ARM))
        cls.data = dyn.Data(cls.model)
        random = np.random.default_rng(1)
        cls.n = 11
        cls.q = np.stack([dyn.random_configuration(cls.model, k) for k in range(cls.n)])
        cls.v, cls.a = random.normal(size=(2, cls.n, cls.model.nv))
        cls.tau = np.stack([dyn.rnea(cls.model, cls.data, q, v, a) for q, v, a in zip(cls.q, cls.v, cls.a)])
        cls.mass = np.stack([dyn.crba(cls.model, cls.data, q) for q in cls.q])


class Graphs(Generated):
    def test_traced_functions_compute_one_state_or_many(self):
        self.assertIn("rnea", dyn.traceable_functions())
        rnea = dyn.trace(self.model, "rnea")
        self.assertEqual(([x.name for x in rnea.inputs], [x.rows for x in rnea.outputs]), (["q", "v", "a"], [self.model.nv]))
        np.testing.assert_allclose(rnea(self.q[0], self.v[0], self.a[0]), self.tau[0], atol=1e-11)
        np.testing.assert_allclose(rnea(self.q, self.v, self.a), self.tau, atol=1e-11)
        np.testing.assert_allclose(rnea(self.q[3], self.v[3], self.a[:5])[3], self.tau[3], atol=1e-11)
        crba = dyn.trace(self.model, "crba")
        np.testing.assert_allclose(crba(self.q[0]), self.mass[0], atol=1e-12)
        np.testing.assert_allclose(crba(self.q), self.mass, atol=1e-12)
        self.assertEqual(rnea(self.q[:0], self.v[:0], self.a[:0]).shape, (0, self.model.nv))

    def test_graphs_show_their_operations(self):
        graph = dyn.trace(self.model, "rnea").graph
        counts = graph.count()
        self.assertEqual(counts.total, counts.additions + counts.multiplications + counts.divisions + counts.functions + counts.selections)
        self.assertEqual((graph.inputs, graph.outputs), (self.model.nq + 2 * self.model.nv, self.model.nv))
        for k, node in enumerate(graph.nodes):
            if node.operation != "input":
                self.assertTrue(all(argument < k for argument in node.arguments))
        flat = np.concatenate([self.q[0], self.v[0], self.a[0]])
        np.testing.assert_allclose(graph(flat), self.tau[0], atol=1e-11)

    def test_derivatives_of_graphs_agree_with_each_other_and_with_differences(self):
        graph = dyn.trace(self.model, "rnea").graph
        x = np.concatenate([self.q[0], self.v[0], self.a[0]])
        jacobians = []
        for mode in ("forward", "reverse"):
            derivative = dyn.differentiate(graph, mode)
            dense = np.zeros((derivative.sparsity.rows, derivative.sparsity.columns))
            dense[derivative.sparsity.row, derivative.sparsity.column] = derivative.graph(x)
            jacobians.append(dense)
        np.testing.assert_allclose(jacobians[0], jacobians[1], atol=1e-10)
        h = 1e-6
        for k in range(graph.inputs):
            step = h * np.eye(graph.inputs)[k]
            np.testing.assert_allclose((graph(x + step) - graph(x - step)) / (2 * h), jacobians[0][:, k], atol=1e-6)
        weights, direction = np.random.default_rng(3).normal(size=graph.outputs), np.random.default_rng(4).normal(size=graph.inputs)
        np.testing.assert_allclose(dyn.gradient(graph)(np.concatenate([x, weights])), weights @ jacobians[0], atol=1e-10)
        np.testing.assert_allclose(dyn.directional(graph)(np.concatenate([x, direction])), jacobians[0] @ direction, atol=1e-10)
        with self.assertRaisesRegex(dyn.Error, "mode is 'both'; it must be one of 'forward', 'reverse'"):
            dyn.differentiate(graph, "both")

    def test_functions_written_in_python_become_graphs(self):
        graph = dyn.trace_function(lambda x, y: [dyn.sin(x[0]) * y[1], x[0] / y[0], 3.0], 1, 2)
        self.assertEqual((graph.inputs, graph.outputs), (3, 3))
        np.testing.assert_allclose(graph([0.5, 2.0, 4.0]), [4 * np.sin(0.5), 0.25, 3.0])
        slope = dyn.differentiate(graph)
        dense = np.zeros((3, 3))
        dense[slope.sparsity.row, slope.sparsity.column] = slope.graph([0.5, 2.0, 4.0])
        np.testing.assert_allclose(dense, [[4 * np.cos(0.5), 0, np.sin(0.5)], [0.5, -0.125, 0], [0, 0, 0]])
        with self.assertRaisesRegex(dyn.Error, "codegen_test.py"):
            dyn.trace_function(lambda x: 1 if x[0] > 0 else 2, 1)

    def test_blocks_of_a_jacobian_are_found_by_name(self):
        rnea = dyn.trace(self.model, "rnea")
        blocks = dyn.jacobian_blocks(rnea)
        dense = blocks(self.q[0], self.v[0], self.a[0])
        self.assertEqual(set(dense), {("tau", "q"), ("tau", "v"), ("tau", "a")})
        np.testing.assert_allclose(dense["tau", "a"], self.mass[0], atol=1e-11)
        expected = dyn.compute_rnea_derivatives(self.model, self.data, self.q[0], self.v[0], self.a[0])
        np.testing.assert_allclose(dense["tau", "v"], expected.dtau_dv, atol=1e-10)
        many = blocks(self.q, self.v, self.a)
        np.testing.assert_allclose(many["tau", "a"], self.mass, atol=1e-11)
        self.assertEqual(blocks.function.name, "jac_rnea")
        self.assertEqual(len(blocks.blocks), 3)

    def test_wrong_arguments_are_named(self):
        rnea = dyn.trace(self.model, "rnea")
        q, v, a = self.q[0], self.v[0], self.a[0]
        for arguments, message in (
            ((q, v), "takes 3 arguments, and 2 were given"),
            ((q[1:], v, a), r"rnea: q has the shape \(\d,\); it must be"),
            ((self.q[:3], self.v[:4], a), r"rnea: v has the shape \(4, \d\); it must be \(\d,\) or \(3, \d\)"),
            ((q, v, "a"), "rnea: a must be an array of numbers"),
            ((q, v, a + 1j), "rnea: a must be an array of numbers, not an array of dtype complex128"),
        ):
            with self.assertRaisesRegex((TypeError, dyn.Error), message):
                rnea(*arguments)
        with self.assertRaisesRegex(dyn.Error, "rnea_derivatives"):
            dyn.trace(self.model, "rneas")
        with self.assertRaisesRegex(dyn.Error, "the inputs have 1 numbers, and the graph has"):
            dyn.TracedFunction("f", rnea.graph, [dyn.ArgumentShape("q", 1)], rnea.outputs)


class Source(Generated):
    def test_source_is_written_in_parts_and_compiles(self):
        functions = [dyn.trace(self.model, name) for name in ("rnea", "crba")]
        source = dyn.write_source(functions, prefix="arm_")
        self.assertIn("void arm_rnea(", source.declarations)
        self.assertEqual(len(source.steps), 2)
        self.assertIn('#include "arm.h"', source.code("arm.h"))
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "arm.c"
            path.write_text(source.code())
            subprocess.run([os.environ.get("CC", "cc"), "-std=c99", "-fsyntax-only", path], check=True)
        self.assertIn("float", dyn.write_source(functions, single_precision=True).types)
        with self.assertRaises(dyn.Error):
            dyn.write_source(functions, lanes=3)

    def test_casadi_source_has_the_interface_of_externals(self):
        text = dyn.write_casadi_source([dyn.trace(self.model, "rnea")])
        for name in ("rnea_n_in", "rnea_sparsity_out", "jac_rnea"):
            self.assertIn(name, text)
        self.assertNotIn("jac_rnea", dyn.write_casadi_source([dyn.trace(self.model, "rnea")], jacobians=False))


class Native(Generated):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        os.chmod(self.folder.name, 0o700)

    def test_compiled_functions_compute_one_state_or_many(self):
        lines = []
        native = dyn.compile_native(self.model, ["rnea", "crba"], cache=self.folder.name, flags=["-O1"], progress=lines.append)
        self.assertEqual([f.name for f in native.functions], ["rnea", "crba"])
        self.assertEqual([line.split(",")[0] for line in lines], ["tracing rnea", "tracing crba", "compiling rnea", "compiling crba"])
        rnea = native["rnea"]
        self.assertFalse(rnea.cached)
        np.testing.assert_allclose(rnea(self.q[0], self.v[0], self.a[0]), self.tau[0], atol=1e-11)
        np.testing.assert_allclose(rnea(self.q, self.v, self.a), self.tau, atol=1e-11)
        np.testing.assert_allclose(native.function("crba")(self.q), self.mass, atol=1e-12)
        again = dyn.compile_native(self.model, ["rnea"], cache=self.folder.name, flags=["-O1"])
        self.assertTrue(again["rnea"].cached)
        np.testing.assert_array_equal(again["rnea"](self.q, self.v, self.a), rnea(self.q, self.v, self.a))
        np.testing.assert_array_equal(rnea(list(self.q[0]), self.v[0], self.a[0]), rnea(self.q[0], self.v[0], self.a[0]))
        np.testing.assert_array_equal(rnea(self.q[0], np.zeros(self.model.nv, int), self.a[0]), rnea(self.q[0], 0 * self.v[0], self.a[0]))
        for wrong, message in (
            ((self.q[0][1:], self.v[0], self.a[0]), "rnea: q has 6 entries, and must have 7"),
            ((self.q[0], self.v[0]), "takes 3 arguments, and 2 were given"),
            ((self.q[0], self.v[0], self.a[0] + 1j), "rnea: a must be an array of numbers"),
            ((self.q[0], self.v[0], "a"), "rnea: a must be an array of numbers"),
        ):
            with self.assertRaisesRegex((TypeError, dyn.Error), message):
                rnea(*wrong)
        with self.assertRaisesRegex(dyn.Error, "aba"):
            native["aba"]

    def test_lanes_and_float32(self):
        lanes = dyn.compile_native(self.model, ["rnea"], lanes=4, cache=self.folder.name, flags=["-O1"])["rnea"]
        self.assertEqual(lanes.lanes, 4)
        np.testing.assert_allclose(lanes(self.q, self.v, self.a), self.tau, atol=1e-11)
        np.testing.assert_allclose(lanes(self.q[2], self.v[2], self.a[2]), self.tau[2], atol=1e-11)
        for width in (1, 4):
            single = dyn.compile_native(self.model, ["rnea"], single_precision=True, lanes=width, cache=self.folder.name, flags=["-O1"])["rnea"]
            tau = single(self.q, self.v.astype(np.float32), self.a)
            self.assertEqual(tau.dtype, np.float32)
            np.testing.assert_allclose(tau, self.tau, rtol=1e-3, atol=1e-3)
            self.assertEqual(single(self.q[0], self.v[0], self.a[0]).shape, (self.model.nv,))

    def test_derivatives_of_graphs_are_compiled_too(self):
        rnea = dyn.trace(self.model, "rnea")
        blocks = dyn.jacobian_blocks(rnea)
        weights, slopes = [dyn.ArgumentShape("weights", self.model.nv)], [dyn.ArgumentShape("d" + x.name, x.rows) for x in rnea.inputs]
        derivative = dyn.TracedFunction("slope", dyn.gradient(rnea.graph), rnea.inputs + weights, slopes)
        native = dyn.compile_native([blocks.function, derivative], cache=self.folder.name, flags=["-O1"])
        for compiled, run in zip(native.functions[0](self.q, self.v, self.a), blocks.function(self.q, self.v, self.a)):
            np.testing.assert_allclose(compiled, run, atol=1e-10)
        by_q, by_v, by_a = native["slope"](self.q, self.v, self.a, self.a)
        np.testing.assert_allclose(by_a, np.einsum("kij,kj->ki", self.mass, self.a), atol=1e-10)

    def test_failures_of_the_compiler_are_errors(self):
        with self.assertRaisesRegex(dyn.Error, "no compiler 'no-such-cc'") as caught:
            dyn.compile_native(self.model, ["rnea"], compiler="no-such-cc", cache=self.folder.name)
        self.assertEqual(caught.exception.code, "compiler")
        with self.assertRaisesRegex(dyn.Error, "operations"):
            dyn.compile_native(self.model, ["rnea"], operations=10, cache=self.folder.name)

        def stop(line):
            raise KeyError(line)

        with self.assertRaisesRegex(KeyError, "tracing rnea"):
            dyn.compile_native(self.model, ["rnea"], cache=self.folder.name, flags=["-O0"], progress=stop)


if __name__ == "__main__":
    unittest.main()
