# SPDX-License-Identifier: BSD-2-Clause
"""Kinematics, dynamics and their derivatives of robots that are described at run time.

    import libdyn as dyn

    model = dyn.compile(dyn.load("robot.urdf", root="free_flyer"))
    data = dyn.Data(model)
    q = dyn.neutral(model)
    tau = dyn.rnea(model, data, q, v, a)

Names are those of the C++ library in Python's style: computeRNEADerivatives is compute_rnea_derivatives. Functions take and return numpy arrays.
"""

import os

from . import _core
from ._core import *  # noqa: F403
from ._core import __version__  # noqa: F401

for _thing in vars(_core).values():
    if getattr(_thing, "__module__", None) == _core.__name__ and isinstance(_thing, type):
        _thing.__module__ = __name__


def load(path, *, root="fixed", mimic="coupled", order="name", continuous="unit_circle", inertias="physical"):
    """Reads a robot from a file; returns a Model.

    root: the joint type between world and root link, such as "free_flyer". mimic: "coupled" or "independent". order: siblings by "name" or as in
    the "file". continuous: a continuous joint's q is a point of the "unit_circle" or an "angle". inertias: "physical", or "any" to load what no body
    has. Raises Error with the file and line of what is wrong.
    """
    return _core._load(os.fspath(path), root=root, mimic=mimic, order=order, continuous=continuous, inertias=inertias)
