# SPDX-License-Identifier: BSD-2-Clause
"""A typed program over the names of Pinocchio: mypy --strict accepts it, and it runs."""
from __future__ import annotations

import sys

import numpy as np
from numpy.typing import NDArray

import libdyn
import libdyn.pinocchio as pin

Vector = NDArray[np.float64]


def dynamics(model: pin.Model, data: pin.Data) -> Vector:
    q: Vector = pin.neutral(model)
    v, a = np.zeros(model.nv), np.ones(model.nv)
    tau: Vector = pin.rnea(model, data, q, v, a)
    M: Vector = pin.crba(model, data, q)
    dtau_dq, dtau_dv, dtau_da = pin.computeRNEADerivatives(model, data, q, v, a)
    energy: float = pin.computeKineticEnergy(model, data, q, v) + data.kinetic_energy
    assert energy == 0 and dtau_dq.shape == dtau_dv.shape == dtau_da.shape == M.shape
    return tau - M @ a - pin.nle(model, data, q, v)


def kinematics(model: pin.Model, data: pin.Data) -> Vector:
    q = pin.randomConfiguration(pin.buildSampleModelManipulator())
    assert len(q) == 6
    pin.forwardKinematics(model, data, pin.neutral(model), np.zeros(model.nv))
    pin.updateFramePlacements(model, data)
    foot: int = model.getFrameId("left_foot")
    placement: pin.SE3 = data.oMf[foot]
    last: pin.SE3 = data.oMi[-1]
    velocity: pin.Motion = pin.getFrameVelocity(model, data, foot, pin.LOCAL_WORLD_ALIGNED)
    J: Vector = pin.computeFrameJacobian(model, data, pin.neutral(model), foot, pin.LOCAL)
    assert not velocity.vector.any() and J.shape == (6, model.nv) and last.translation.shape == (3,)
    return placement.rotation @ placement.translation


def spatial() -> float:
    M: pin.SE3 = pin.SE3.Random() * pin.SE3(np.eye(3), np.zeros(3)).inverse()
    v: pin.Motion = M.act(pin.Motion.Random()) + pin.Motion.Zero()
    f: pin.Force = pin.Inertia.Random() * v
    rotated = pin.Quaternion(M.rotation).normalized().toRotationMatrix()
    assert np.allclose(rotated, M.rotation) and isinstance(pin.log6(M), pin.Motion)
    own: libdyn.Force = f  # libdyn's functions take it
    assert own.vector.shape == (6,)
    return v.dot(f)


def built() -> pin.Model:
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "hinge")
    model.appendBodyToJoint(joint, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3.Identity())
    model.lowerPositionLimit[0] = -1.0
    model.inertias[joint].mass = 2.0
    names: list[str] = model.names
    assert names == ["universe", "hinge"]
    return model


def contacts(model: pin.Model, data: pin.Data) -> Vector:
    contact = pin.RigidConstraintModel(pin.ContactType.CONTACT_3D, model, model.njoints - 1, pin.SE3.Identity())
    models, datas = [contact], [contact.createData()]
    pin.initConstraintDynamics(model, data, models)
    zero = np.zeros(model.nv)
    ddq: Vector = pin.constraintDynamics(model, data, pin.neutral(model), zero, zero, models, datas)
    force: pin.Force = datas[0].contact_force
    assert force.linear.shape == (3,) and data.lambda_c.shape == (3,)
    return ddq


def main(path: str) -> None:
    model: pin.Model = pin.buildModelFromUrdf(path, pin.JointModelFreeFlyer())
    data = model.createData()
    assert np.allclose(dynamics(model, data), 0, atol=1e-10)
    kinematics(model, data)
    spatial()
    assert contacts(model, data).shape == (model.nv,)
    robot = pin.RobotWrapper.BuildFromURDF(path)
    assert robot.nq == robot.model.nq and built().nv == 1


if __name__ == "__main__":
    main(sys.argv[1])
