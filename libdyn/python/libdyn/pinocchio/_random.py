# SPDX-License-Identifier: BSD-2-Clause
"""The source of random numbers of Random(), setRandom() and randomConfiguration()."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._types import Array

_generator = np.random.default_rng()


def seed(value: int) -> None:
    """Starts a new sequence of random numbers. The same value gives the same sequence."""
    global _generator
    _generator = np.random.default_rng(int(value))


def uniform(*shape: Any) -> Array:
    """Returns an array of this shape with numbers between -1 and 1."""
    return _generator.uniform(-1.0, 1.0, shape)


def integer() -> int:
    """Returns an integer from 0 to 2^63 - 1, a seed for libdyn's own functions."""
    return int(_generator.integers(2**63))


def quaternion() -> Array:
    """Returns a unit quaternion (4,) of a uniformly random rotation."""
    x = _generator.standard_normal(4)
    return x / np.linalg.norm(x)
