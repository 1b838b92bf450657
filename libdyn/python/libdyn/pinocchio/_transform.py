# SPDX-License-Identifier: BSD-2-Clause
"""Poses with the names of hpp-fcl."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn

from ._arrays import PRECISION
from .rotations import Quaternion
from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array


class Transform3f:
    """A pose, as hpp-fcl has it. Transform3f(), Transform3f(SE3), Transform3f(R or quaternion, T), Transform3f(R or quaternion or T)."""

    __hash__ = None

    def __init__(self, rotation: Any = None, translation: Optional[ArrayLike] = None) -> None:
        self._pose = SE3()
        if isinstance(rotation, Transform3f):
            self._pose = rotation._pose.copy()
        elif isinstance(rotation, libdyn.SE3):
            self._pose = SE3(rotation)
        elif rotation is not None and translation is None and np.shape(rotation) == (3,):
            self._pose.translation = rotation
        elif rotation is not None:
            self._pose.rotation = rotation.matrix() if isinstance(rotation, Quaternion) else rotation
            if translation is not None:
                self._pose.translation = translation

    def getRotation(self) -> Array:
        return self._pose.rotation

    def getTranslation(self) -> Array:
        return self._pose.translation

    def getQuatRotation(self) -> Quaternion:
        return Quaternion(self._pose.rotation)

    def setRotation(self, R: ArrayLike) -> None:
        self._pose.rotation = R

    def setTranslation(self, T: ArrayLike) -> None:
        self._pose.translation = T

    def setQuatRotation(self, q: Quaternion) -> None:
        self._pose.rotation = q.matrix()

    def setTransform(self, rotation: Any, translation: ArrayLike) -> None:
        self._pose = Transform3f(rotation, translation)._pose

    def setIdentity(self) -> None:
        self._pose.setIdentity()

    def setRandom(self) -> None:
        self._pose.setRandom()

    def isIdentity(self, prec: float = PRECISION) -> bool:
        return self._pose.isIdentity(prec)

    def transform(self, v: ArrayLike) -> Array:
        """Returns the point (3,) in the outer frame."""
        return self._pose.act(v)

    def inverse(self) -> Transform3f:
        return Transform3f(self._pose.inverse())

    def inverseInPlace(self) -> Self:
        self._pose = self._pose.inverse()
        return self

    def inverseTimes(self, other: Transform3f) -> Transform3f:
        return Transform3f(self._pose.actInv(other._pose))

    def __mul__(self, other: Transform3f) -> Transform3f:
        return Transform3f(self._pose * other._pose)

    def __imul__(self, other: Transform3f) -> Self:
        self._pose = self._pose * other._pose
        return self

    def __eq__(self, other: Transform3f) -> bool:
        return self._pose == other._pose if isinstance(other, Transform3f) else NotImplemented

    def __reduce__(self) -> tuple[Any, ...]:
        return Transform3f, (self._pose,)

    @staticmethod
    def Identity() -> Transform3f:
        return Transform3f()

    @staticmethod
    def Random() -> Transform3f:
        return Transform3f(SE3.Random())


Transform3s = Transform3f
