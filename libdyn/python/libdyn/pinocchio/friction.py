# SPDX-License-Identifier: BSD-2-Clause
"""Coulomb's friction cones, and joint forces for a wanted motion while points touch with friction."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from .constraints import getConstraintsJacobian
from .containers import instances, typed_list
from .convert import vector
from .dynamics import rnea
from .enums import LOCAL
from .kinematics import forwardKinematics
from .spatial import Force

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array
    from .constraints import ProximalSettings, RigidConstraintData, RigidConstraintModel
    from .data import Data
    from .model import Model
    from .rotations import Quaternion


class _Cone:
    """A cone of vectors (tangential, tangential, normal) with the coefficient mu."""

    def __init__(self, mu: Any) -> None:
        self.mu = float(getattr(mu, "mu", mu))
        if not self.mu >= 0:
            raise ValueError(f"{type(self).__name__}: mu is {self.mu}; it must not be negative")

    def _slope(self):
        """Returns the sine and cosine of half the opening angle."""
        raise NotImplementedError

    def isInside(self, f: ArrayLike, prec: float = 0.0) -> bool:
        """Returns whether a vector is in the cone, to within prec."""
        sine, cosine = self._slope()
        f = vector(f, 3, "isInside", "f")
        return bool(cosine * np.hypot(f[0], f[1]) <= sine * f[2] + prec * cosine)

    def project(self, f: ArrayLike) -> Array:
        """Returns the nearest vector of the cone (3,)."""
        f = vector(f, 3, "project", "f")
        sine, cosine = self._slope()
        radius = np.hypot(f[0], f[1])
        if cosine * radius <= sine * f[2]:
            return f.copy()
        along = sine * radius + cosine * f[2]  # the length along the cone's surface
        if along <= 0:
            return np.zeros(3)
        return along * np.array([sine * f[0] / radius, sine * f[1] / radius, cosine])

    @staticmethod
    def dim() -> int:
        """Returns 3, the dimension."""
        return 3

    def copy(self) -> Self:
        """Returns a copy."""
        return type(self)(self.mu)

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.mu == other.mu

    __hash__ = None


class CoulombFrictionCone(_Cone):
    """Forces whose tangential part is at most mu times their normal part."""

    def _slope(self):
        length = np.hypot(1.0, self.mu)
        return self.mu / length, 1 / length

    def dual(self) -> DualCoulombFrictionCone:
        """Returns the dual cone."""
        return DualCoulombFrictionCone(self.mu)

    def weightedProject(self, f: ArrayLike, R: Union[Quaternion, ArrayLike]) -> Array:
        """Returns the vector x of the cone that minimises (x - f) . R (x - f), with R (3,) equal in both tangential directions."""
        roots = np.sqrt(vector(R, 3, "weightedProject", "R"))
        return CoulombFrictionCone(self.mu * roots[0] / roots[2]).project(roots * vector(f, 3, "weightedProject", "f")) / roots

    def computeNormalCorrection(self, v: ArrayLike) -> Array:
        """Returns (0, 0, mu |tangential part of v|): with it, sliding velocities and forces are complementary."""
        v = vector(v, 3, "computeNormalCorrection", "v")
        return np.array([0.0, 0.0, self.mu * np.hypot(v[0], v[1])])

    def computeRadialProjection(self, f: ArrayLike) -> Array:
        """Returns the vector of the cone with the same normal part, or zero if that pulls, and the nearest tangential part."""
        f = vector(f, 3, "computeRadialProjection", "f")
        normal, radius = max(0.0, f[2]), np.hypot(f[0], f[1])
        scale = self.mu * normal / radius if radius > self.mu * normal else 1.0
        return np.array([scale * f[0], scale * f[1], normal])


class DualCoulombFrictionCone(_Cone):
    """Velocities whose normal part is at least mu times their tangential part."""

    def _slope(self):
        length = np.hypot(1.0, self.mu)
        return 1 / length, self.mu / length

    def dual(self) -> CoulombFrictionCone:
        """Returns the cone of forces."""
        return CoulombFrictionCone(self.mu)


StdVec_CoulombFrictionCone = typed_list("StdVec_CoulombFrictionCone", instances(CoulombFrictionCone), __name__)
StdVec_DualCoulombFrictionCone = typed_list("StdVec_DualCoulombFrictionCone", instances(DualCoulombFrictionCone), __name__)


def computeContactImpulses(
    model: Model,
    data: Data,
    c_ref: ArrayLike,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
    cones: Sequence[CoulombFrictionCone],
    R: Union[Quaternion, ArrayLike],
    constraint_correction: ArrayLike,
    settings: ProximalSettings,
    impulse_guess: Optional[ArrayLike] = None,
) -> Array:
    """Returns the impulses (rows,) of contacts of points that move at c_ref + R impulse; also data.impulse_c.

    c_ref has the velocities of the points without compliance, R the compliances of the rows. Each impulse is in its cone, and where a point slides,
    the impulse opposes it. settings.mu regularises; settings.max_iter and relative_accuracy limit the iterations.
    """
    name = "computeContactImpulses"
    rows = 3 * len(contact_models)
    if any(x.size() != 3 for x in contact_models) or len(cones) != len(contact_models):
        raise ValueError(f"{name}: contacts must be of points (CONTACT_3D), with a cone each")
    R = vector(R, rows, name, "R")
    velocity = vector(c_ref, rows, name, "c_ref") + vector(constraint_correction, rows, name, "constraint_correction")
    impulse = np.zeros(rows) if impulse_guess is None else vector(impulse_guess, rows, name, "impulse_guess").copy()
    if not settings.mu > 0:
        raise ValueError(f"{name}: settings.mu must be positive")
    weights = R + settings.mu
    for settings.iter in range(1, settings.max_iter + 1):
        before = impulse.copy()
        for k, cone in enumerate(cones):
            mine = slice(3 * k, 3 * k + 3)
            shift = cone.computeNormalCorrection(velocity[mine] + R[mine] * impulse[mine])
            free = -(velocity[mine] + shift - settings.mu * before[mine]) / weights[mine]
            impulse[mine] = cone.weightedProject(free, weights[mine])
        settings.relative_residual = float(np.abs(impulse - before).max(initial=0.0))
        if settings.relative_residual <= settings.relative_accuracy * max(np.abs(impulse).max(initial=0.0), np.abs(before).max(initial=0.0)):
            break
    data.impulse_c = impulse
    return impulse


def contactInverseDynamics(
    model: Model,
    data: Data,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    dt: float,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
    cones: Sequence[CoulombFrictionCone],
    R: Union[Quaternion, ArrayLike],
    constraint_correction: ArrayLike,
    settings: ProximalSettings,
    lambda_guess: Optional[ArrayLike] = None,
) -> Array:
    """Returns the joint forces (nv,) for the acceleration a, with the contact forces that computeContactImpulses finds for the velocities v + dt a.

    Also data.tau and lambda_c, forces on the points in the axes of their contacts.
    """
    forwardKinematics(model, data, q, v)
    J = getConstraintsJacobian(model, data, contact_models, contact_datas)
    velocity = J @ (vector(v, model.nv, "contactInverseDynamics", "v") + dt * vector(a, model.nv, "contactInverseDynamics", "a"))
    guess = None if lambda_guess is None else dt * vector(lambda_guess, len(J), "contactInverseDynamics", "lambda_guess")
    impulses = computeContactImpulses(model, data, velocity, contact_models, contact_datas, cones, R, constraint_correction, settings, guess)
    data.lambda_c = impulses / dt
    forces = [Force.Zero() for _ in range(model.njoints)]
    for k, (contact, result) in enumerate(zip(contact_models, contact_datas)):
        mine = data.lambda_c[3 * k : 3 * k + 3]
        result.contact_force = Force(mine, np.zeros(3))
        local = result.contact_force if contact.reference_frame == LOCAL else Force(result.oMc1.rotation.T @ mine, np.zeros(3))
        forces[contact.joint1_id] += contact.joint1_placement.act(local)
        forces[contact.joint2_id] -= contact.joint2_placement.act(result.c1Mc2.actInv(local))
    return rnea(model, data, q, v, a, forces)
