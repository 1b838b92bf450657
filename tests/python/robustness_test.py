# SPDX-License-Identifier: BSD-2-Clause
"""Memory, references, threads and forks: nothing leaks, and nothing crashes."""
import gc
import multiprocessing
import os
import pathlib
import pickle
import sys
import threading
import unittest

import numpy as np

import libdyn as dyn

BIPED = pathlib.Path(__file__).parents[2] / "models" / "biped.urdf"


def resident():
    """Returns the memory that the process has now [bytes]."""
    return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def pendulum():
    model = dyn.Model()
    model.add_body("rod", 0, dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]}), dyn.Inertia(2.0, [0, 0, -1.0], 0.01 * np.eye(3)))
    model.add_geometry("bob", "rod", dyn.Sphere(0.1))
    model.add_geometry("ground", 0, dyn.HalfSpace([0, 0, 1], -2))
    return model


def batch_torques(threads, q):
    """Returns joint forces of many states; it runs in forked processes."""
    model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
    v = np.zeros((len(q), model.nv))
    return dyn.rnea(model, dyn.BatchData(model, len(q), threads=threads), q, v, v)


class Memory(unittest.TestCase):
    def grows(self, work, times):
        """Returns by how much memory grows [bytes] when work is repeated, after it has been done often enough to fill caches."""
        for _ in range(times // 4):
            work()
        gc.collect()
        before = resident()
        for _ in range(times):
            work()
        gc.collect()
        return resident() - before

    def test_models_made_and_dropped_leave_no_memory_behind(self):
        description = pendulum()

        def work():
            model = dyn.compile(description)
            data = dyn.Data(model)
            data.joint("hinge")
            dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.lock_joint("hinge")]))

        # With those before the measurement these are 10^5 models; a leak of 16 bytes a model would be 1.3 MB.
        self.assertLess(self.grows(work, 80000), 1 << 20)

    def test_simulators_volumes_and_graphs_leave_no_memory_behind(self):
        description = pendulum()
        model = dyn.compile(description)

        def work():
            volumes = dyn.compile_geometry(model, description)
            simulator = dyn.Simulator(model)
            simulator.set_contacts(dyn.geometry_contacts(model, volumes))
            simulator.set_controller(lambda t, q, v: -v)
            simulator.advance(0.003)
            dyn.rollout(model, [0.1], [0.0], np.zeros((2, 2, 1)), 0.01, threads=2)
            rnea = dyn.trace(model, "rnea")
            rnea([0.1], [0.2], [0.3])
            dyn.jacobian_blocks(rnea)([0.1], [0.2], [0.3])

        self.assertLess(self.grows(work, 1000), 1 << 20)

    def test_a_million_calls_leave_no_memory_and_no_references_behind(self):
        model = dyn.compile(pendulum())
        data, out = dyn.Data(model), np.empty(1)
        q, v, a = np.array([0.1]), np.array([0.2]), np.array([0.3])
        watched = (model, data, q, v, a, out)
        before = [sys.getrefcount(x) for x in watched]

        def work():
            for _ in range(100):
                dyn.rnea(model, data, q, v, a)
                dyn.rnea(model, data, q, v, a, out=out)
                dyn.crba(model, data, q)
                dyn.aba(model, data, q, v, a)
            dyn.forward_kinematics(model, data, q, v)
            data.joint("hinge").placement.p[0] = 1.0
            dyn.frame_velocity(model, data, "rod").linear
            try:
                dyn.rnea(model, data, q, v, [0.0, 0.0])
            except dyn.Error:
                pass

        self.assertLess(self.grows(work, 2500), 1 << 19)
        gc.collect()
        self.assertEqual([sys.getrefcount(x) for x in watched], before)

    def test_results_and_views_outlive_what_made_them(self):
        model = dyn.compile(pendulum())
        data = dyn.Data(model)
        tau = dyn.rnea(model, data, [0.1], [0.2], [0.3])
        kept = tau.copy()
        dyn.forward_kinematics(model, data, [0.1], [0.2])
        place, p = data.frame("rod"), data.frame("rod").placement.p
        island = dyn.IslandSimulator(pendulum()).island(0)
        names = model.q_index
        del model, data
        gc.collect()
        np.testing.assert_array_equal(tau, kept)
        np.testing.assert_array_equal(place.placement.p, p)
        island.advance(0.01)
        self.assertEqual(names["hinge"], slice(0, 1, 1))


    def test_parts_of_a_description_outlive_it(self):
        body = dyn.load(BIPED).bodies[1]
        bodies = iter(dyn.load(BIPED).bodies)
        p = dyn.load(BIPED).bodies[2].joint.placement.p
        growing = pendulum()
        before = iter(growing.bodies)
        for k in range(200):
            growing.add_body(f"body{k}", k, dyn.JointDescription(f"joint{k}", "fixed"))
        gc.collect()
        dyn.load(BIPED)
        self.assertEqual((body.name, next(bodies).name, p.shape), ("torso", "universe", (3,)))
        self.assertEqual([x.name for x in before], ["universe", "rod"])

    def test_views_of_results_keep_their_data(self):
        model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        q, zero = dyn.neutral(model), np.zeros(model.nv)
        tau = dyn.rnea(model, dyn.Data(model), q, zero, zero, out="view")
        expected = dyn.rnea(model, dyn.Data(model), q, zero, zero)
        others = [dyn.Data(model) for _ in range(20)]
        for data in others:
            dyn.rnea(model, data, q, zero, zero + 1)
        np.testing.assert_array_equal(tau, expected)

    def test_data_of_constraints_keep_their_set(self):
        model = dyn.compile(pendulum())
        held = dyn.ConstraintData(dyn.ConstraintSet(model, [dyn.lock_joint("hinge")]))
        gc.collect()
        dyn.constraint_dynamics(model, dyn.Data(model), [0.1], [0.0], [0.0], held)
        self.assertEqual(len(held.set), 1)


class Threads(unittest.TestCase):
    def test_threads_that_share_a_data_get_right_results(self):
        # Calls of a single state hold the interpreter's lock, so each sees its own results only.
        model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        data = dyn.Data(model)
        states = [(dyn.random_configuration(model, k), np.full(model.nv, 0.1 * k)) for k in range(4)]
        expected = [dyn.rnea(model, dyn.Data(model), q, v, v) for q, v in states]
        wrong = []

        def work(k):
            q, v = states[k]
            for _ in range(2000):
                if not np.array_equal(dyn.rnea(model, data, q, v, v), expected[k]):
                    wrong.append(k)

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_a_simulator_serves_one_thread_at_a_time(self):
        simulator = dyn.Simulator(dyn.compile(pendulum()), dt=1e-5)
        refused, done = [], threading.Event()

        def intrude():
            while not done.is_set():
                try:
                    simulator.time  # noqa: B018
                except RuntimeError as error:
                    refused.append(str(error))

        thread = threading.Thread(target=intrude)
        thread.start()
        while not refused:
            simulator.advance(simulator.time + 1.0)
        done.set()
        thread.join()
        self.assertIn("another thread is advancing", refused[0])

    def test_simulators_in_threads_run_side_by_side(self):
        model = dyn.compile(pendulum())
        results = {}

        def work(k):
            simulator = dyn.Simulator(model, dt=1e-4)
            simulator.reset([0.1 * k], [0.0])
            simulator.advance(1.0)
            results[k] = simulator.q[0]

        threads = [threading.Thread(target=work, args=(k,)) for k in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        alone = dict(results)
        for k in range(4):
            work(k)
        self.assertEqual(results, alone)


    def test_simulators_that_share_a_finder_wait_for_each_other(self):
        description = pendulum()
        model = dyn.compile(description)
        finder = dyn.geometry_contacts(model, dyn.compile_geometry(model, description))
        results = []

        def work():
            simulator = dyn.Simulator(model, dt=1e-3)
            simulator.set_contacts(dyn.together(finder, dyn.ContactFinder(lambda q, reach: [])))
            simulator.reset([0.5], [0.0])
            simulator.advance(0.5)
            results.append(simulator.q[0])

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(len(results), 4)
        np.testing.assert_allclose(results, results[0], atol=1e-12)


class Forks(unittest.TestCase):
    def test_batches_work_in_forked_processes(self):
        model = dyn.compile(dyn.load(BIPED, root="free_flyer"))
        q = np.stack([dyn.random_configuration(model, k) for k in range(20)])
        v = np.zeros((20, model.nv))
        batch = dyn.BatchData(model, 20, threads=2)
        expected = dyn.rnea(model, batch, q, v, v)
        with multiprocessing.get_context("fork").Pool(2) as pool:
            for result in pool.starmap(batch_torques, [(2, q), (1, q)]):
                np.testing.assert_array_equal(result, expected)
        child = os.fork()
        if child == 0:
            # The batch of the parent has lost its threads here and starts new ones.
            right = np.array_equal(dyn.rnea(model, batch, q, v, v), expected)
            right = right and dyn.rollout(model, q[0], v[0], np.zeros((3, 2, model.nv)), 0.01, threads=2)[0].shape == (3, 3, model.nq)
            os._exit(0 if right else 1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        np.testing.assert_array_equal(dyn.rnea(model, batch, q, v, v), expected)


    def test_a_simulation_goes_on_in_a_forked_process(self):
        def advanced(simulators):
            for simulator in simulators:
                simulator.advance(0.02)
            return [simulator.time for simulator in simulators] + [float(simulators[0].q[0])]

        description = pendulum()
        simulator = dyn.Simulator(dyn.compile(description), dt=1e-3)
        simulator.set_controller(lambda t, q, v: -v)
        simulator.reset([0.5], [0.0])
        simulators = [simulator, dyn.IslandSimulator(description, dt=1e-3)]
        simulator.advance(0.01)
        read, write = os.pipe()
        child = os.fork()
        if child == 0:
            os.write(write, repr(advanced(simulators)).encode())
            os._exit(0)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), 0)
        self.assertEqual(os.read(read, 1000).decode(), repr(advanced(simulators)))
        os.close(read)
        os.close(write)


class Misuse(unittest.TestCase):
    def test_what_cannot_be_pickled_says_what_can(self):
        model = dyn.compile(pendulum())
        for thing in (model, dyn.Data(model), dyn.BatchData(model, 1)):
            with self.assertRaisesRegex(TypeError, "cannot be pickled; pickle the Model, and"):
                pickle.dumps(thing)

    def test_objects_that_were_never_made_are_refused(self):
        model = dyn.compile(pendulum())
        for empty in (dyn.Data.__new__(dyn.Data), dyn.BatchData.__new__(dyn.BatchData)):
            with self.assertRaisesRegex(TypeError, "__init__ has not run"):
                dyn.rnea(model, empty, [0.0], [0.0], [0.0])
        with self.assertRaisesRegex(TypeError, "__init__ has not run"):
            dyn.rnea(dyn.CompactModel.__new__(dyn.CompactModel), dyn.Data(model), [0.0], [0.0], [0.0])

        class Mine(dyn.Data):
            def __init__(self):
                pass

        with self.assertRaisesRegex(TypeError, "__init__"):
            Mine()

    def test_data_of_another_model_is_refused(self):
        model, other = dyn.compile(pendulum()), dyn.compile(dyn.load(BIPED))
        data = dyn.Data(other)
        for call in (
            lambda: dyn.forward_kinematics(model, data, [0.0]),
            lambda: dyn.compute_frame_jacobian(model, data, [0.0], 1),
            lambda: dyn.compute(model, data, ["rnea"], [0.0]),
            lambda: dyn.frame_placement(model, data, 1),
            lambda: dyn.rnea(model, dyn.BatchData(other, 2), [[0.0]], [[0.0]], [[0.0]]),
            lambda: dyn.rollout(dyn.ConstraintSet(other), [0.0], [0.0], [[[0.0]]], 0.1),
        ):
            with self.assertRaises((TypeError, dyn.Error)):
                call()

    def test_indices_out_of_range_are_refused(self):
        model = dyn.compile(pendulum())
        data = dyn.Data(model)
        dyn.forward_kinematics(model, data, [0.0], [0.0], [0.0])
        for index in (-1, 99, 2**31 - 1):
            for function in (dyn.frame_placement, dyn.joint_placement, dyn.frame_velocity, dyn.get_joint_jacobian):
                with self.assertRaises(dyn.Error):
                    function(model, data, index)
        with self.assertRaises((TypeError, dyn.Error)):
            dyn.frame_placement(model, data, 2**40)
        with self.assertRaises(dyn.Error):
            dyn.ConstraintSet(model).description(0)


if __name__ == "__main__":
    unittest.main()
