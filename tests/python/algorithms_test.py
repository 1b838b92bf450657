# SPDX-License-Identifier: BSD-2-Clause
"""Algorithms called with numpy's arrays: results, arguments of every kind, errors."""
import gc
import pathlib
import pickle
import sys
import threading
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


def biped():
    return dyn.compile(dyn.load(BIPED, root="free_flyer"))


class Algorithms(unittest.TestCase):
    def setUp(self):
        self.model = biped()
        self.data = dyn.Data(self.model)
        random = np.random.default_rng(1)
        self.q = dyn.random_configuration(self.model, 1)
        self.v, self.a = random.normal(size=(2, self.model.nv))

    def test_results_satisfy_the_equations_of_motion(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        tau = dyn.rnea(model, data, q, v, a)
        mass = dyn.crba(model, data, q)
        np.testing.assert_allclose(mass @ a + dyn.non_linear_effects(model, data, q, v), tau, atol=1e-10)
        np.testing.assert_allclose(dyn.aba(model, data, q, v, tau), a, atol=1e-9)
        np.testing.assert_allclose(dyn.compute_minverse(model, data, q) @ mass, np.eye(model.nv), atol=1e-9)

    def test_derivatives_agree_with_differences(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        result = dyn.compute_rnea_derivatives(model, data, q, v, a)
        h = 1e-6
        for k in range(model.nv):
            step = h * np.eye(model.nv)[k]
            ahead = dyn.rnea(model, data, dyn.integrate(model, q, step), v, a)
            behind = dyn.rnea(model, data, dyn.integrate(model, q, -step), v, a)
            np.testing.assert_allclose((ahead - behind) / (2 * h), result.dtau_dq[:, k], atol=1e-5)
            ahead, behind = dyn.rnea(model, data, q, v + step, a), dyn.rnea(model, data, q, v - step, a)
            np.testing.assert_allclose((ahead - behind) / (2 * h), result.dtau_dv[:, k], atol=1e-5)
        np.testing.assert_allclose(result.M, dyn.crba(model, data, q), atol=1e-12)

    def test_named_results_are_pickled(self):
        result = dyn.compute_rnea_derivatives(self.model, self.data, self.q, self.v, self.a)
        other = pickle.loads(pickle.dumps(result))
        self.assertIs(type(other), dyn.compute_rnea_derivatives_result)
        np.testing.assert_array_equal(other.dtau_dv, result.dtau_dv)

    def test_every_sequence_of_numbers_is_an_argument(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        expected = dyn.rnea(model, data, q, v, a)
        for form in (list, tuple, lambda x: np.stack([x, x], 1)[:, 0], lambda x: x.astype(">f8"), lambda x: np.asfortranarray(x)):
            np.testing.assert_array_equal(dyn.rnea(model, data, form(q), form(v), a=form(a)), expected)
        zero = np.zeros(model.nv)
        np.testing.assert_array_equal(dyn.rnea(model, data, q, np.zeros(model.nv, int), zero), dyn.rnea(model, data, q, zero, zero))
        np.testing.assert_array_equal(dyn.rnea(model=model, data=data, q=q, v=v, a=a), expected)

    def test_wrong_arguments_are_named(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        for arguments, message in (
            ((model, data, q[1:], v, a), "q has 22 entries, the model wants 23"),
            ((model, data, q, np.stack([v, v]), a), r"v must be an array .* shape \(2, 22\)"),
            ((model, data, q + 1j, v, a), "complex128"),
            ((model, data, q, v, "a"), "a must be .* not <class 'str'>"),
            ((model, data, q, v), "misses the argument 'a'"),
            ((model, data, q, v, a, a), "takes 5 positional arguments"),
            ((data, data, q, v, a), "model must be a CompactModel"),
            ((model, model, q, v, a), "data must be a Data"),
            ((model, None, q, v, a), "data must be a Data"),
        ):
            with self.assertRaisesRegex((TypeError, dyn.Error), message):
                dyn.rnea(*arguments)
        with self.assertRaisesRegex(TypeError, "no argument 'w'"):
            dyn.rnea(model, data, q, v, a, w=a)
        with self.assertRaisesRegex(TypeError, "two values for argument 'q'"):
            dyn.rnea(model, data, q, v, a, q=q)

    def test_out_takes_the_result_whatever_its_strides(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        n = model.nv
        tau = np.full(n, np.nan)
        self.assertIs(dyn.rnea(model, data, q, v, a, out=tau), tau)
        np.testing.assert_array_equal(tau, dyn.rnea(model, data, q, v, a))
        for mass in (np.empty((n, n)), np.empty((n, n), order="F"), np.empty((2 * n, 2 * n))[::2, ::2]):
            dyn.crba(model, data, q, out=mass)
            np.testing.assert_array_equal(mass, dyn.crba(model, data, q))
        outputs = tuple(np.empty((n, n)) for _ in range(3))
        dyn.compute_rnea_derivatives(model, data, q, v, a, out=outputs)
        np.testing.assert_array_equal(outputs[1], dyn.compute_rnea_derivatives(model, data, q, v, a).dtau_dv)
        frozen = np.empty(n)
        frozen.flags.writeable = False
        for wrong in (np.empty(n + 1), np.empty(n, np.float32), frozen, [0.0] * n, np.empty((n, 1))):
            with self.assertRaisesRegex(TypeError, "out must be a writable array of float64"):
                dyn.rnea(model, data, q, v, a, out=wrong)

    def test_views_show_the_memory_of_the_data_and_keep_it_alive(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        mass = dyn.crba(model, data, q, out="view")
        np.testing.assert_array_equal(mass, dyn.crba(model, data, q))
        self.assertIs(mass.base, data)
        tau = dyn.rnea(model, data, q, v, a, out="view")
        first = tau.copy()
        np.testing.assert_allclose(dyn.aba(model, data, q, v, tau), a, atol=1e-9)
        dyn.rnea(model, data, q, 2 * v, a)
        self.assertTrue(np.any(tau != first))
        with self.assertRaises(ValueError):
            tau[0] = 1.0
        with self.assertRaises(ValueError):
            tau.flags.writeable = True
        self.assertEqual(dyn.compute_rnea_derivatives(model, data, q, v, a, out="view").M.shape, (model.nv, model.nv))
        with self.assertRaises(TypeError):
            dyn.rnea(model, data, q, v, a, out="views")
        expected = dyn.crba(model, data, q)
        del self.data, data
        gc.collect()
        np.testing.assert_array_equal(mass, expected)

    def test_external_forces_act_on_joints(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        forces = np.zeros((model.njoints, 6))
        forces[3] = [1, 2, 3, 4, 5, 6]
        jacobian = dyn.compute_joint_jacobian(model, data, q, 3, dyn.LOCAL)
        free = dyn.rnea(model, data, q, v, a)
        np.testing.assert_allclose(dyn.rnea(model, data, q, v, a, fext=forces), free - jacobian.T @ forces[3], atol=1e-11)
        np.testing.assert_allclose(dyn.aba(model, data, q, v, free - jacobian.T @ forces[3], fext=forces), a, atol=1e-9)
        gravity = dyn.generalized_gravity(model, data, q)
        np.testing.assert_allclose(dyn.compute_static_torque(model, data, q, forces), gravity - jacobian.T @ forces[3], atol=1e-11)
        with self.assertRaises(TypeError):
            dyn.rnea(model, data, q, v, a, fext=forces[:, :5])

    def test_results_belong_to_the_caller(self):
        first = dyn.rnea(self.model, self.data, self.q, self.v, self.a)
        kept = first.copy()
        dyn.rnea(self.model, self.data, self.q, 2 * self.v, self.a)
        np.testing.assert_array_equal(first, kept)
        first[0] = 1.0

    def test_calls_leave_no_references_behind(self):
        model, data, q, v, a = self.model, self.data, self.q, self.v, self.a
        out = np.empty(model.nv)
        watched = (model, data, q, v, a, out, dyn.rnea)

        def calls():
            for _ in range(10000):
                dyn.rnea(model, data, q, v, a)
                dyn.rnea(model, data, q, v, a, out=out)
                dyn.crba(model, data, q)
            for _ in range(100):
                dyn.compute_rnea_derivatives(model, data, q, v, a)
                for wrong in (q[1:], "q"):
                    try:
                        dyn.rnea(model, data, wrong, v, a)
                    except (TypeError, dyn.Error):
                        pass

        calls()
        gc.collect()
        before = [sys.getrefcount(x) for x in watched]
        blocks = sys.getallocatedblocks()
        calls()
        gc.collect()
        self.assertEqual([sys.getrefcount(x) for x in watched], before)
        self.assertLess(sys.getallocatedblocks() - blocks, 100)


class Batches(unittest.TestCase):
    def setUp(self):
        self.model = biped()
        n = 13
        random = np.random.default_rng(2)
        self.q = np.stack([dyn.random_configuration(self.model, k) for k in range(n)])
        self.v, self.a = random.normal(size=(2, n, self.model.nv))

    def test_rows_are_states(self):
        model, data = self.model, dyn.Data(self.model)
        batch = dyn.BatchData(model, 16, threads=2)
        tau = dyn.rnea(model, batch, self.q, self.v, self.a)
        mass = dyn.crba(model, batch, self.q)
        derivatives = dyn.compute_rnea_derivatives(model, batch, self.q, self.v, self.a)
        self.assertEqual(tau.shape, (13, model.nv))
        for k in range(13):
            np.testing.assert_allclose(tau[k], dyn.rnea(model, data, self.q[k], self.v[k], self.a[k]), atol=1e-11)
            np.testing.assert_allclose(mass[k], dyn.crba(model, data, self.q[k]), atol=1e-11)
            single = dyn.compute_rnea_derivatives(model, data, self.q[k], self.v[k], self.a[k])
            np.testing.assert_allclose(derivatives.dtau_dq[k], single.dtau_dq, atol=1e-9)
            np.testing.assert_allclose(derivatives.dtau_dv[k], single.dtau_dv, atol=1e-9)

    def test_bodies_and_factors_of_all_rows(self):
        model, data = self.model, dyn.Data(self.model, dyn.Need.DERIVATIVES)
        batch = dyn.BatchData(model, 16, dyn.Need.DERIVATIVES, threads=2)
        jacobians = dyn.jacobian_center_of_mass(model, batch, self.q)
        kinetic = dyn.compute_kinetic_energy(model, batch, self.q, self.v)
        potential = dyn.compute_potential_energy(model, batch, self.q)
        still, moving = dyn.center_of_mass(model, batch, self.q), dyn.center_of_mass(model, batch, self.q, self.v, self.a)
        self.assertIsNone(still.velocity)
        self.assertEqual((jacobians.shape, kinetic.shape, moving.position.shape), ((13, 3, model.nv), (13,), (13, 3)))
        np.testing.assert_array_equal(still.position, moving.position)
        dyn.cholesky.decompose(model, batch, self.q)
        solved = dyn.cholesky.solve(model, batch, self.a)
        for k in range(13):
            q, v, a = self.q[k], self.v[k], self.a[k]
            one = dyn.center_of_mass(model, data, q, v, a)
            np.testing.assert_allclose(moving.position[k], one.position, atol=1e-13)
            np.testing.assert_allclose(moving.velocity[k], one.velocity, atol=1e-13)
            np.testing.assert_allclose(moving.acceleration[k], one.acceleration, atol=1e-12)
            np.testing.assert_allclose(jacobians[k], dyn.jacobian_center_of_mass(model, data, q), atol=1e-13)
            np.testing.assert_allclose(kinetic[k], dyn.compute_kinetic_energy(model, data, q, v), rtol=1e-12)
            np.testing.assert_allclose(potential[k], dyn.compute_potential_energy(model, data, q), rtol=1e-12)
            np.testing.assert_allclose(solved[k], dyn.compute_minverse(model, data, q) @ a, atol=1e-8)
        with self.assertRaises(dyn.Error):
            dyn.cholesky.solve(model, batch, self.a[:4])

    def test_any_layout_and_type_of_rows(self):
        model, batch = self.model, dyn.BatchData(self.model, 16)
        expected = dyn.rnea(model, batch, self.q, self.v, self.a)
        for form in (np.asfortranarray, lambda x: x.tolist(), lambda x: np.repeat(x, 2, 0)[::2], lambda x: np.repeat(x, 2, 1)[:, ::2]):
            np.testing.assert_array_equal(dyn.rnea(model, batch, form(self.q), form(self.v), form(self.a)), expected)
        floats = dyn.BatchDataFloat(model, 16)
        for kind in (np.float32, np.float64):
            tau = dyn.rnea(model, floats, self.q.astype(kind), self.v.astype(kind), self.a.astype(kind))
            self.assertEqual(tau.dtype, np.float32)
            np.testing.assert_allclose(tau, expected, rtol=2e-3, atol=2e-3 * np.abs(expected).max())

    def test_wrong_batches_are_refused(self):
        model, batch = self.model, dyn.BatchData(self.model, 4)
        for arguments, message in (
            ((self.q, self.v, self.a), "13"),
            ((self.q[:3], self.v[:4], self.a[:3]), "v"),
            ((self.q[:3, 1:], self.v[:3], self.a[:3]), "q"),
            ((self.q[0], self.v[0], self.a[0]), "two dimensions"),
        ):
            with self.assertRaisesRegex((TypeError, dyn.Error), message):
                dyn.rnea(model, batch, *arguments)
        with self.assertRaisesRegex(TypeError, "batches have no 'out'"):
            dyn.rnea(model, batch, self.q[:3], self.v[:3], self.a[:3], out=np.empty((3, model.nv)))

    def test_two_threads_on_one_batch_get_results_or_an_error(self):
        model, batch = self.model, dyn.BatchData(self.model, 2048)
        q, v, a = (np.tile(x, (150, 1)) for x in (self.q, self.v, self.a))
        expected = dyn.rnea(model, batch, q, v, a)
        outcomes = []

        def work():
            for _ in range(50):
                try:
                    outcomes.append(np.array_equal(dyn.rnea(model, batch, q, v, a), expected))
                except RuntimeError as error:
                    outcomes.append("another thread is using this batch" in str(error))

        threads = [threading.Thread(target=work) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(outcomes, [True] * 150)


if __name__ == "__main__":
    unittest.main()
