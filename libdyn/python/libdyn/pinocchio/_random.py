# SPDX-License-Identifier: BSD-2-Clause
"""The source of random numbers of Random(), setRandom() and randomConfiguration()."""

import numpy as np

_generator = np.random.default_rng()


def seed(value):
    """Starts a new sequence of random numbers. The same value gives the same sequence."""
    global _generator
    _generator = np.random.default_rng(int(value))


def uniform(*shape):
    """Returns an array of this shape with numbers between -1 and 1."""
    return _generator.uniform(-1.0, 1.0, shape)


def integer():
    """Returns an integer from 0 to 2^63 - 1, a seed for libdyn's own functions."""
    return int(_generator.integers(2**63))


def quaternion():
    """Returns a unit quaternion (4,) of a uniformly random rotation."""
    x = _generator.standard_normal(4)
    return x / np.linalg.norm(x)
