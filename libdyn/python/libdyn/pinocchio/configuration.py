# SPDX-License-Identifier: BSD-2-Clause
"""Functions on configurations."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

import libdyn as dyn

from . import _random, convert
from .calls import compiled
from .enums import ARG0, ARG1
from .joints import JointModelComposite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .. import ArgumentPosition
    from ._types import Array
    from .model import Model


def neutral(model: Model) -> Array:
    """Returns the configuration (nq,) at which every joint is at its zero."""
    c = compiled(model, "neutral")
    return c.q_out(dyn.neutral(c.model))


def integrate(model: Model, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns q (+) v (nq,)."""
    c = compiled(model, "integrate")
    return c.q_out(dyn.integrate(c.model, c.q_in(q, "integrate"), c.v_in(v, "integrate", "v")))


def difference(model: Model, q1: ArrayLike, q2: ArrayLike) -> Array:
    """Returns the v (nv,) for which q1 (+) v = q2."""
    c = compiled(model, "difference")
    return c.v_out(dyn.difference(c.model, c.q_in(q1, "difference", "q1"), c.q_in(q2, "difference", "q2")))


def interpolate(model: Model, q1: ArrayLike, q2: ArrayLike, alpha: float) -> Array:
    """Returns q1 (+) alpha (q2 (-) q1) (nq,)."""
    c = compiled(model, "interpolate")
    return c.q_out(dyn.interpolate(c.model, c.q_in(q1, "interpolate", "q1"), c.q_in(q2, "interpolate", "q2"), float(alpha)))


def squaredDistance(model: Model, q1: ArrayLike, q2: ArrayLike) -> Array:
    """Returns for each joint but the universe the square of its distance [m^2, rad^2], (njoints - 1,)."""
    v = difference(model, q1, q2)
    return np.array([v[at : at + n] @ v[at : at + n] for at, n in zip(model.idx_vs[1:], model.nvs[1:])])


def distance(model: Model, q1: ArrayLike, q2: ArrayLike) -> float:
    """Returns the norm of the difference. Metres and radians count alike."""
    return float(np.linalg.norm(difference(model, q1, q2)))


def normalize(model: Model, q: ArrayLike) -> Array:
    """Returns q with its quaternions and (cos, sin) pairs scaled to norm one (nq,)."""
    c = compiled(model, "normalize")
    return c.q_out(dyn.normalize(c.model, c.q_in(q, "normalize")))


def isNormalized(model: Model, q: ArrayLike, prec: float = 1e-12) -> bool:
    """Returns whether every quaternion and pair has norm one to within prec."""
    c = compiled(model, "isNormalized")
    return dyn.is_normalized(c.model, c.q_in(q, "isNormalized"), prec)


def isSameConfiguration(model: Model, q1: ArrayLike, q2: ArrayLike, prec: float = 1e-12) -> bool:
    """Returns whether two configurations place all joints alike, to within prec."""
    return bool(np.all(np.abs(difference(model, q1, q2)) <= prec))


def randomConfiguration(model: Model, lower_bound: Optional[ArrayLike] = None, upper_bound: Optional[ArrayLike] = None) -> Array:
    """Returns a random configuration (nq,) between the bounds, which are the model's limits by default. Rotations without end are uniform.

    Raises RuntimeError for a coordinate without limits.
    """
    lower = convert.vector(model.lowerPositionLimit if lower_bound is None else lower_bound, model.nq, "randomConfiguration", "lower_bound")
    upper = convert.vector(model.upperPositionLimit if upper_bound is None else upper_bound, model.nq, "randomConfiguration", "upper_bound")
    q = np.zeros(model.nq)
    for joint in model.joints[1:]:
        if joint.nv:
            _fill_random(joint, joint.idx_q, lower, upper, q)
    return q


def _fill_random(joint, at, lower, upper, q):
    """Writes random coordinates of a joint to q[at:]."""
    if isinstance(joint, JointModelComposite):
        for part in joint.joints:
            _fill_random(part, at, lower, upper, q)
            at += part.nq
        return
    limited = joint.hasConfigurationLimit()
    bounded = sum(limited)
    for k in range(at, at + bounded):
        if not np.all(np.abs([lower[k], upper[k]]) < np.finfo(float).max):
            raise RuntimeError(f"randomConfiguration: coordinate {k} has no limits; give bounds or set model.lowerPositionLimit, upperPositionLimit")
        q[k] = lower[k] + (upper[k] - lower[k]) * (_random.uniform(1)[0] + 1) / 2
    rest = joint.nq - bounded
    if rest == 4:
        q[at + bounded : at + joint.nq] = _random.quaternion()
    elif rest == 2:
        angle = np.pi * _random.uniform(1)[0]
        q[at + bounded : at + joint.nq] = np.cos(angle), np.sin(angle)


def _derivatives(function, model, a, b, argument):
    """Returns one derivative, or both as a tuple."""
    c = compiled(model, function.__name__)
    both = [c.square_out(function(c.model, a(c), b(c), by)) for by in ((ARG0, ARG1) if argument is None else (argument,))]
    return tuple(both) if argument is None else both[0]


def dIntegrate(model: Model, q: ArrayLike, v: ArrayLike, argument_position: Optional[ArgumentPosition] = None) -> Array:
    """Returns the derivative (nv, nv) of integrate by q (ARG0) or v (ARG1), in tangent vectors; without an argument position, both."""
    return _derivatives(dyn.d_integrate, model, lambda c: c.q_in(q, "dIntegrate"), lambda c: c.v_in(v, "dIntegrate", "v"), argument_position)


def dDifference(model: Model, q1: ArrayLike, q2: ArrayLike, argument_position: Optional[ArgumentPosition] = None) -> Array:
    """Returns the derivative (nv, nv) of difference by q1 (ARG0) or q2 (ARG1), in tangent vectors; without an argument position, both."""
    first, second = (lambda c: c.q_in(q1, "dDifference", "q1")), (lambda c: c.q_in(q2, "dDifference", "q2"))
    return _derivatives(dyn.d_difference, model, first, second, argument_position)


def dIntegrateTransport(model: Model, q: ArrayLike, v: ArrayLike, Jin: ArrayLike, argument_position: ArgumentPosition) -> Array:
    """Returns Jin (nv, k), whose columns are tangent vectors at q (+) v, transported to q along v."""
    Jin = convert.matrix(Jin, model.nv, None, "dIntegrateTransport", "Jin")
    return dIntegrate(model, q, v, argument_position) @ Jin
