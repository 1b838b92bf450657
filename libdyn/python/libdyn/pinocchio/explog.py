# SPDX-License-Identifier: BSD-2-Clause
"""Exponentials, logarithms and their Jacobians, computed by libdyn, which is accurate to rounding at every angle."""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

import libdyn

from ._arrays import array, call
from .rotations import Quaternion
from .spatial import SE3, Motion, own, skew

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array

__all__ = [
    "Hlog3",
    "Jexp3",
    "Jexp6",
    "Jlog3",
    "Jlog6",
    "alphaSkew",
    "exp",
    "exp3",
    "exp3_quat",
    "exp6",
    "exp6_quat",
    "log",
    "log3",
    "log6",
    "log6_quat",
    "skew",
    "skewSquare",
    "unSkew",
]


# Matrices that have drifted from a rotation have a logarithm here, as they have in Pinocchio.
_log3 = functools.partial(libdyn.log3, check=False)


def exp3(w: ArrayLike) -> Array:
    """Returns the rotation matrix (3, 3) of a rotation vector (3,) [rad]."""
    return call(libdyn.exp3, w, (3,), "w")


def exp3_quat(w: ArrayLike) -> Array:
    """Returns the unit quaternion (x, y, z, w) of a rotation vector (3,) [rad]."""
    return call(libdyn.exp3_quaternion, w, (3,), "w")


def Jexp3(w: ArrayLike) -> Array:
    """Returns the right Jacobian (3, 3) of exp3 at w."""
    return call(libdyn.Jexp3, w, (3,), "w")


def log3(R: Union[Quaternion, ArrayLike], theta: Optional[ArrayLike] = None) -> Array:
    """Returns the rotation vector (3,) [rad] of a rotation matrix, a Quaternion, or an array (x, y, z, w); its norm is at most pi.

    theta: an array with one entry, which gets the angle.
    """
    if isinstance(R, Quaternion):
        out = libdyn.log3_quaternion(R.coeffs())
    elif np.size(R) == 4:
        out = libdyn.log3_quaternion(array(R, (4,), "quat"))
    else:
        out = call(_log3, R, (3, 3), "R")
    if isinstance(theta, np.ndarray):
        theta[...] = np.linalg.norm(out)
    return out


def Jlog3(R: Union[Quaternion, ArrayLike]) -> Array:
    """Returns the Jacobian (3, 3) of log3 at a rotation matrix, the inverse of Jexp3(log3(R))."""
    return libdyn.Jlog3(call(_log3, R, (3, 3), "R"))


def Hlog3(R: Union[Quaternion, ArrayLike], v: ArrayLike) -> Array:
    """Returns the derivative (3, 3) of Jlog3 at a rotation matrix along v (3,), the product of v and the Hessian of log3."""
    return libdyn.Hlog3(call(_log3, R, (3, 3), "R"), array(v, (3,), "v"))


def _motion(v):
    return v if isinstance(v, libdyn.Motion) else Motion(array(v, (6,), "v"))


def _pose(M):
    return M if isinstance(M, libdyn.SE3) else SE3(array(M, (4, 4), "M"))


def exp6(motion: Union[Motion, ArrayLike]) -> SE3:
    """Returns the SE3 that a constant motion, a Motion or an array (6,), reaches in unit time."""
    return own(libdyn.SE3.exp(_motion(motion)))


def exp6_quat(v: Union[Motion, ArrayLike]) -> Array:
    """Returns exp6(v) as (x, y, z, qx, qy, qz, qw)."""
    motion = _motion(v)
    return np.concatenate([libdyn.SE3.exp(motion).p, libdyn.exp3_quaternion(motion.angular)])


def Jexp6(motion: Union[Motion, ArrayLike]) -> Array:
    """Returns the right Jacobian (6, 6) of exp6 at a Motion or an array (6,)."""
    return libdyn.Jexp6(_motion(motion))


def log6(M: Union[SE3, ArrayLike]) -> Motion:
    """Returns the constant Motion that leads to an SE3 or a homogeneous matrix (4, 4) in unit time; its angle is at most pi."""
    return own(libdyn.SE3.log(_pose(M)))


def log6_quat(q: ArrayLike) -> Motion:
    """Returns log6 of (x, y, z, qx, qy, qz, qw)."""
    q = array(q, (7,), "q")
    w = libdyn.log3_quaternion(q[3:])
    return Motion(libdyn.Jlog3(w).T @ q[:3], w)


def Jlog6(M: Union[SE3, ArrayLike]) -> Array:
    """Returns the Jacobian (6, 6) of log6 at an SE3, the inverse of Jexp6(log6(M))."""
    return libdyn.Jlog6(libdyn.SE3.log(_pose(M)))


def unSkew(U: ArrayLike) -> Array:
    """Returns the u (3,) of U = skew(u). The symmetric part of U (3, 3) does not matter."""
    U = array(U, (3, 3), "U")
    return 0.5 * np.array([U[2, 1] - U[1, 2], U[0, 2] - U[2, 0], U[1, 0] - U[0, 1]])


def skewSquare(u: ArrayLike, v: ArrayLike) -> Array:
    """Returns skew(u) skew(v) (3, 3)."""
    u, v = array(u, (3,), "u"), array(v, (3,), "v")
    return np.outer(v, u) - (u @ v) * np.eye(3)


def alphaSkew(alpha: float, u: ArrayLike) -> float:
    """Returns alpha skew(u) (3, 3)."""
    return float(alpha) * skew(u)


def exp(x: Any) -> Any:
    """Returns the exponential of a number, of a vector of three (exp3), or of a Motion or a vector of six (exp6). Raises ValueError for others."""
    if isinstance(x, libdyn.Motion):
        return exp6(x)
    if np.isscalar(x):
        return math.exp(x)
    if isinstance(x, np.ndarray) and x.shape in ((6,), (6, 1)):
        return exp6(x)
    if isinstance(x, np.ndarray) and x.shape in ((3,), (3, 1)):
        return exp3(x)
    raise ValueError("exp takes a number, a Motion, or an array of three or six numbers")


def log(x: Any) -> Any:
    """Returns the logarithm of a number, of a rotation matrix (log3), or of an SE3 or a homogeneous matrix (log6). Raises ValueError for others."""
    if isinstance(x, libdyn.SE3):
        return log6(x)
    if np.isscalar(x):
        return math.log(x)
    if isinstance(x, np.ndarray) and x.shape == (4, 4):
        return log6(x)
    if isinstance(x, np.ndarray) and x.shape == (3, 3):
        return log3(x)
    raise ValueError("log takes a number, an SE3, or an array (3, 3) or (4, 4)")
