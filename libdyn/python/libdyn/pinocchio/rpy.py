# SPDX-License-Identifier: BSD-2-Clause
"""Roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

import libdyn

from ._arrays import array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from ._types import Array
    from .rotations import Quaternion

__all__ = [
    "computeRpyJacobian",
    "computeRpyJacobianInverse",
    "computeRpyJacobianTimeDerivative",
    "matrixToRpy",
    "rotate",
    "rpyToMatrix",
]


def rotate(axis: str, angle: float) -> Array:
    """Returns the rotation matrix by an angle [rad] about "x", "y" or "z". Raises ValueError for another axis."""
    if axis not in ("x", "y", "z"):
        raise ValueError(f"axis is {axis!r}; it must be 'x', 'y' or 'z'")
    w = np.zeros(3)
    w["xyz".index(axis)] = angle
    return libdyn.exp3(w)


def rpyToMatrix(roll: Any, pitch: Optional[float] = None, yaw: Optional[float] = None) -> Array:
    """Returns the rotation matrix of three angles [rad], or of an array of the three."""
    r, p, y = (array(roll, (3,), "rpy") if pitch is None else (roll, pitch, yaw))
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(t), math.cos(t)) for t in (r, p, y))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def matrixToRpy(R: Union[Quaternion, ArrayLike]) -> Array:
    """Returns (roll, pitch, yaw) [rad] of a rotation matrix: roll and yaw from -pi to pi, pitch from -pi/2 to pi/2.

    Where the pitch is a right angle, roll and yaw are not unique; any pair that gives R is returned.
    """
    (r00, r01, r02), (r10, r11, r12), (r20, _, _) = array(R, (3, 3), "R").tolist()
    yaw = math.atan2(r10, r00)
    sy, cy = math.sin(yaw), math.cos(yaw)
    # Rz(-yaw) R = Ry(pitch) Rx(roll), whatever the rounding of the yaw.
    pitch = math.atan2(-r20, cy * r00 + sy * r10)
    roll = math.atan2(sy * r02 - cy * r12, cy * r11 - sy * r01)
    return np.array([roll, pitch, yaw])


def _trigonometry(rpy):
    r, p, y = array(rpy, (3,), "rpy").tolist()
    return math.sin(r), math.cos(r), math.sin(p), math.cos(p), math.sin(y), math.cos(y)


def _is_local(reference_frame):
    return reference_frame == libdyn.LOCAL


def computeRpyJacobian(rpy: ArrayLike, reference_frame: ReferenceFrame = libdyn.LOCAL) -> Array:
    """Returns the matrix (3, 3) that maps the rates of (roll, pitch, yaw) to the angular velocity.

    reference_frame: LOCAL for the angular velocity in the moving frame; WORLD and LOCAL_WORLD_ALIGNED for that in the fixed one.
    """
    sr, cr, sp, cp, sy, cy = _trigonometry(rpy)
    if _is_local(reference_frame):
        return np.array([[1.0, 0.0, -sp], [0.0, cr, sr * cp], [0.0, -sr, cr * cp]])
    return np.array([[cp * cy, -sy, 0.0], [cp * sy, cy, 0.0], [-sp, 0.0, 1.0]])


def computeRpyJacobianInverse(rpy: ArrayLike, reference_frame: ReferenceFrame = libdyn.LOCAL) -> Array:
    """Returns the inverse of computeRpyJacobian (3, 3). It is unbounded where the pitch is a right angle."""
    sr, cr, sp, cp, sy, cy = _trigonometry(rpy)
    tp = sp / cp
    if _is_local(reference_frame):
        return np.array([[1.0, sr * tp, cr * tp], [0.0, cr, -sr], [0.0, sr / cp, cr / cp]])
    return np.array([[cy / cp, sy / cp, 0.0], [-sy, cy, 0.0], [cy * tp, sy * tp, 1.0]])


def computeRpyJacobianTimeDerivative(rpy: ArrayLike, rpydot: ArrayLike, reference_frame: ReferenceFrame = libdyn.LOCAL) -> Array:
    """Returns the time derivative (3, 3) of computeRpyJacobian for the rates rpydot (3,) [rad/s]."""
    sr, cr, sp, cp, sy, cy = _trigonometry(rpy)
    dr, dp, dy = array(rpydot, (3,), "rpydot").tolist()
    if _is_local(reference_frame):
        return np.array(
            [
                [0.0, 0.0, -cp * dp],
                [0.0, -sr * dr, cr * cp * dr - sr * sp * dp],
                [0.0, -cr * dr, -sr * cp * dr - cr * sp * dp],
            ]
        )
    return np.array(
        [
            [-sp * cy * dp - cp * sy * dy, -cy * dy, 0.0],
            [-sp * sy * dp + cp * cy * dy, -sy * dy, 0.0],
            [-cp * dp, 0.0, 0.0],
        ]
    )
