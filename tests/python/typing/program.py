# SPDX-License-Identifier: BSD-2-Clause
"""A typed program: mypy --strict accepts it, and it runs.."""
from __future__ import annotations

import pathlib
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

import libdyn as dyn

Vector = NDArray[np.float64]


def torque(model: dyn.CompactModel, data: dyn.Data, q: Vector) -> Vector:
    zero = np.zeros(model.nv)
    tau = np.empty(model.nv)
    dyn.rnea(model, data, q, zero, zero, out=tau)
    same: Vector = dyn.rnea(model, data, q, zero, [0.0] * model.nv, fext=np.zeros((model.njoints, 6)))
    return tau - same


def derivatives(model: dyn.CompactModel, data: dyn.Data, q: Vector) -> Vector:
    zero = np.zeros(model.nv)
    result = dyn.compute_rnea_derivatives(model, data, q, zero, zero)
    dtau_dq, dtau_dv, M = result
    assert np.array_equal(result.dtau_dq, dtau_dq) and np.array_equal(result.dtau_dv, dtau_dv)
    arrays = (np.empty_like(M), np.empty_like(M), np.empty_like(M))
    again: tuple[Vector, ...] = dyn.compute_rnea_derivatives(model, data, q, zero, zero, out=arrays)
    return again[2] - M


def batches(model: dyn.CompactModel, q: Vector) -> NDArray[np.float32]:
    many = np.tile(q, (5, 1))
    double = dyn.BatchData(model, 5, threads=2)
    single = dyn.BatchDataFloat(model, 5)
    M: Vector = dyn.crba(model, double, many)
    M32: NDArray[np.float32] = dyn.crba(model, single, many)
    parts = dyn.compute_rnea_derivatives(model, single, many, np.zeros((5, model.nv)), np.zeros((5, model.nv)))
    of_float: NDArray[np.float32] = parts.dtau_dq
    assert M.shape == M32.shape == of_float.shape
    return M32


def spatial() -> dyn.SE3:
    X = dyn.SE3.translation(0, 0, 1) @ dyn.SE3.rotation([0, 0, 0.3])
    X.p = [1, 2, 3]
    X.p[0] = 2
    motion: dyn.Motion = X @ dyn.Motion([1, 0, 0], np.zeros(3))
    force: dyn.Force = X.act(dyn.Force())
    point: Vector = X @ [1, 2, 3]
    power = float(motion.vector @ force.vector)
    assert power == 0 and point.shape == (3,)
    assert 2 * motion == motion + motion
    return X.inverse()


def pendulum() -> dyn.Model:
    robot = dyn.Model()
    hinge = dyn.JointDescription("hinge", "revolute", {"axis": np.array([0, 1, 0])})
    hinge.damping = 0.1
    hinge.lower, hinge.upper = -3, [3.0]
    robot.add_body("rod", 0, hinge, dyn.Inertia(2.0, [0, 0, -1], 0.01 * np.eye(3)))
    robot.gravity = [0, 0, -9.81]
    robot.bodies[1].inertia.com = [0, 0, -1]
    return robot


def simulation(model: dyn.CompactModel) -> float:
    simulator = dyn.Simulator(model, integrator="rk4", dt=1e-3)
    simulator.reset(dyn.neutral(model), [1.0])

    def controller(t: float, q: Vector, v: Vector) -> Vector:
        return -0.1 * v

    simulator.set_controller(controller)
    simulator.set_events([("top", lambda t, q, v: float(q[0] - 3), "rising")])
    event: int = simulator.advance(0.1, times=[0.05], observer=lambda t, q, v: None)
    steps: int = simulator.statistics["steps"]
    assert event == -1 and steps > 0
    return simulator.energy


def joint_of_our_own() -> dyn.SE3:
    @dyn.joint(nq=1, parameters={"h": "m", "n": dyn.Parameter(usual=[1.0])}, compiled=False)
    def typed_cam(q: NDArray[np.object_], p: Any) -> dyn.SE3:
        """A cam."""
        return dyn.SE3.translation(0, 0, p.h * (1 - dyn.cos(p.n * q[0])))

    joint: dyn.JointFunction = typed_cam
    assert joint.nv == 1 and "typed_cam" in dyn.joint.source(joint)
    return joint([0.3], h=0.1)


def errors(robot: dyn.Model) -> tuple[str, int]:
    try:
        dyn.compile(robot, lock={"hing": 0.0})
    except dyn.Error as problem:
        return problem.code, problem.line
    raise AssertionError


def main(path: str | pathlib.Path) -> None:
    robot = dyn.load(path, root="free_flyer")
    model = dyn.compile(robot, outputs=[])
    data = dyn.Data(model, dyn.Need.MASS_MATRIX | dyn.Need.DERIVATIVES)
    q = dyn.random_configuration(model, 1)
    assert np.allclose(torque(model, data, q), 0, atol=1e-10) and not np.any(derivatives(model, data, q))
    batches(model, q)
    where: slice = model.q_index[model.joint("root_joint").name]
    assert q[where].shape == (7,)
    J: Vector = dyn.compute_frame_jacobian(model, data, q, model.frames[-1].name, dyn.LOCAL_WORLD_ALIGNED)
    assert J.shape == (6, model.nv)
    spatial()
    joint_of_our_own()
    simulation(dyn.compile(pendulum()))
    assert errors(pendulum()) == ("model", 0)


if __name__ == "__main__":
    main(sys.argv[1])
