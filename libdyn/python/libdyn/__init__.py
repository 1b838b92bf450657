# SPDX-License-Identifier: BSD-2-Clause
"""Kinematics, dynamics and their derivatives of robots that are described at run time.

    import libdyn as dyn

    model = dyn.compile(dyn.load("robot.urdf", root="free_flyer"))
    data = dyn.Data(model)
    q = dyn.neutral(model)
    tau = dyn.rnea(model, data, q, v, a)

Names are those of the C++ library in Python's style: computeRNEADerivatives is compute_rnea_derivatives. Functions take and return numpy arrays.
"""
import os as _os
import runpy as _runpy

from . import _loading

try:
    from . import _core
    from ._core import *  # noqa: F403
    from ._core import Error, Model
    from ._core import __version__ as __version__
except ImportError as _problem:
    raise ImportError(_loading.remedy(_problem)) from _problem

# Each name is imported as itself, which tells type checkers that it belongs to the package.
from ._errors import error as _error
from .graphs import trace_function as trace_function
from .joint_types import JointFunction as JointFunction, Parameter as Parameter, joint as joint
from .sweeps import sweep as sweep
from .tracing import Scalar as Scalar, TracedSE3 as TracedSE3, select as select
from .tracing import atan2 as atan2, cos as cos, exp as exp, log as log, sin as sin, sqrt as sqrt, tan as tan


def load(
    path: "str | _os.PathLike[str]",
    *,
    root: str = "fixed",
    mimic: str = "coupled",
    order: str = "name",
    continuous: str = "unit_circle",
    inertias: str = "physical",
    files: str = "beside",
    versions: str = "known",
    format: str = "",
) -> Model:
    """Reads a robot from a file; returns a Model.

    The file's ending tells its format, or its content does: URDF, MJCF, SDF, RBDL's Lua, libdyn's own (.dyn.json), or a Python file that leaves a
    `model` (.py). format: the name of a format, such as "sdf", if neither tells it.
    root: the joint type between world and root link, such as "free_flyer". mimic: "coupled" or "independent". order: siblings by "name" or as in
    the "file". continuous: a continuous joint's q is a point of the "unit_circle" or an "angle". inertias: "physical", or "any" to load what no body
    has. files: files that the model includes lie "beside" it or in folders below, or "anywhere". versions: "known", or "any" to read files of newer
    versions of their format as far as they are understood. Raises Error with the file and line of what is wrong. A Python file is run, with all that
    it may do.
    """
    path = _os.fspath(path)
    if format == "python" or (not format and path.endswith(".py")):
        return _left_by(path, root)
    return _core._load(
        path, root=root, mimic=mimic, order=order, continuous=continuous, inertias=inertias, files=files, versions=versions, format=format)


def _left_by(path: str, root: str) -> Model:
    """Runs a Python file and returns the model that it leaves."""
    if root != "fixed":
        raise _error("model", f"makes its own joint between world and robot, so that the root joint '{root}' does not apply", path)
    model = _runpy.run_path(path).get("model")
    if not isinstance(model, Model):
        left = "none" if model is None else type(model).__name__
        raise _error("model", f"must leave a libdyn.Model called `model`; it leaves {left}", path)
    return model


def check(
    path: "str | _os.PathLike[str]",
    *,
    root: str = "fixed",
    mimic: str = "coupled",
    order: str = "name",
    continuous: str = "unit_circle",
    inertias: str = "physical",
    files: str = "beside",
    versions: str = "known",
    format: str = "",
) -> "list[Error]":
    """Returns a list of all errors of a file, of which load() raises the first; it is empty if the file loads. The options are those of load()."""
    return _core._check(
        _os.fspath(path), root=root, mimic=mimic, order=order, continuous=continuous, inertias=inertias, files=files, versions=versions,
        format=format)
