# SPDX-License-Identifier: BSD-2-Clause
"""Joint types written in Python.

The function of a joint runs once, on traced numbers. The C++ source of a plugin is written from what it did, compiled by the system's compiler into
the cache of generated code, and loaded. From then on the type is like any other, in every algorithm, with derivatives and in batches.
"""

import dataclasses
import functools
import inspect
import os
import pathlib
import shutil
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from ._core import SE3, Error
from .tracing import Array, Tape, TracedSE3, refusal

Traced = tuple[int, list[tuple[Any, ...]], list[int]]  #: Inputs, operations and outputs of a function.


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A parameter of a joint type: unit, how many numbers it has, its meaning, and its value where a model leaves it out."""

    unit: str = ""
    size: int = 1
    help: str = ""
    usual: Optional[Sequence[float]] = None

    def numbers(self) -> list[float]:
        """Returns the usual value as a list; an empty one if there is none."""
        return [] if self.usual is None else [float(x) for x in np.ravel(self.usual)]


class JointFunction:
    """A joint type written in Python. A call computes its pose: cam([0.3], h=0.1)."""

    def __init__(self, function: Callable[..., Any], traced: _core._TracedJoint, nq: int, nv: int, parameters: dict[str, Parameter]) -> None:
        functools.update_wrapper(self, function)
        self.name = function.__name__
        self.nq, self.nv, self.parameters = nq, nv, parameters
        self.path: Optional[str] = None  #: The plugin's file; None if the graph itself is run.
        self._function, self._traced = function, traced

    def __call__(self, q: ArrayLike, **parameters: ArrayLike) -> SE3:
        """Returns the pose (SE3) at the coordinates q (nq,); parameters by name."""
        unknown = sorted(set(parameters) - set(self.parameters))
        if unknown:
            raise TypeError(f"joint type '{self.name}' has no parameter '{unknown[0]}'; it has {', '.join(self.parameters) or 'none'}")
        values = {}
        for name, parameter in self.parameters.items():
            value = np.ravel(np.asarray(parameters.get(name, parameter.numbers()), dtype=float))
            if value.shape != (parameter.size,):
                raise TypeError(f"joint type '{self.name}' needs {parameter.size} numbers for its parameter '{name}', not {value.size}")
            values[name] = value if parameter.size > 1 else float(value[0])
        q = np.asarray(q, dtype=float)
        if q.shape != (self.nq,):
            raise TypeError(f"joint type '{self.name}' has {self.nq} coordinates; q has shape {q.shape}")
        R, p = _parts(self._function(q, types.SimpleNamespace(**values)))
        return SE3(np.asarray(R, dtype=float), np.asarray(p, dtype=float))

    def __repr__(self) -> str:
        return f"<joint type '{self.name}': nq = {self.nq}, nv = {self.nv}>"


def _parts(pose: Any) -> tuple[Array, Array]:
    """Returns R and p of what a joint's function returned."""
    if isinstance(pose, (SE3, TracedSE3)):
        return pose.R, pose.p
    if isinstance(pose, (tuple, list)) and len(pose) == 2:
        pose = TracedSE3(*pose)
        return pose.R, pose.p
    array = np.asarray(pose, dtype=object)
    if array.shape == (4, 4):
        return array[:3, :3], array[:3, 3]
    raise TypeError("the function of a joint returns an SE3, a pair of R (3, 3) and p (3,), or a homogeneous matrix (4, 4)")


def _traced(function: Callable[..., Any], sizes: list[int], parameters: dict[str, Parameter], outputs: Callable[[Any], Array]) -> Traced:
    """Runs a function on traced arrays of these sizes, and the parameters; returns what _TracedJoint takes."""
    tape = Tape()
    arguments = [tape.input(size) for size in sizes]
    values = {}
    for name, parameter in parameters.items():
        numbers = tape.input(parameter.size)
        values[name] = numbers if parameter.size > 1 else numbers[0]
    result = function(*arguments, types.SimpleNamespace(**values))
    flat = np.ravel(np.asarray(outputs(result), dtype=object))
    return tape.inputs, tape.nodes, [tape.index(x) for x in flat]


def _vector_of(what: str, size: int) -> Callable[[Any], Array]:
    def outputs(result: Any) -> Array:
        vector = np.ravel(np.asarray(result, dtype=object))
        if vector.shape != (size,):
            raise TypeError(f"{what} must return {size} numbers, not {vector.size}")
        return vector

    return outputs


def _pose(result: Any) -> Array:
    R, p = _parts(result)
    return np.concatenate([np.ravel(R), np.ravel(p)])


class _Joint:
    """Makes a joint type of a function pose(q, p). Use it as a decorator:

        @libdyn.joint(nq=1, parameters={"h": "m"})
        def cam(q, p):
            return libdyn.SE3.translation(0, 0, p.h * (1 - libdyn.cos(q[0])))

    The function gets traced coordinates q (nq,) and the parameters p by name, and returns the pose of the moved frame in the fixed frame: an SE3, a
    pair (R, p) or a matrix (4, 4). Its name is the type's name in models, and the first line of its docstring the type's summary.

    nq, nv: numbers of coordinates and degrees of freedom; nv is nq if it is left out.
    parameters: a dictionary of names with units, or with a Parameter, whose size may be greater than 1.
    neutral(p), integrate(q, v, p), difference(q0, q1, p), normalize(q, p): the configuration space, if q (+) v is not q + v; see the SDK's
    documents. rates(q, v, p) is dq/dt; without it, it is derived from `integrate`.
    compiled: False runs the operations one by one, much slower, where there is no compiler.

    Raises Error with the line where a function decides by a traced number, and Error with code "compiler" if there is no C++ compiler. The first
    definition takes the compiler's seconds; later ones, in other processes too, find the plugin in the cache. A new definition replaces one of the
    same name; compiled models keep theirs.
    """

    def __init__(self) -> None:
        self._known: dict[str, JointFunction] = {}  # the joints by name

    def __call__(
        self,
        nq: int,
        nv: Optional[int] = None,
        *,
        parameters: Optional[Mapping[str, Union[str, Parameter]]] = None,
        neutral: Optional[Callable[..., Any]] = None,
        integrate: Optional[Callable[..., Any]] = None,
        difference: Optional[Callable[..., Any]] = None,
        normalize: Optional[Callable[..., Any]] = None,
        rates: Optional[Callable[..., Any]] = None,
        compiled: bool = True,
    ) -> Callable[[Callable[..., Any]], JointFunction]:
        given = {"neutral": neutral, "integrate": integrate, "difference": difference, "normalize": normalize}
        space = {name: function for name, function in given.items() if function is not None}
        if (space or rates) and len(space) < len(given):
            missing = sorted(set(given) - set(space))[0]
            raise refusal(f"a configuration space needs all of neutral, integrate, difference and normalize; there is no {missing}")
        if inspect.isfunction(nq):
            raise TypeError("write @libdyn.joint(nq=...), with the number of coordinates")
        dofs = nq if nv is None else nv
        described = {}
        for name, parameter in (parameters or {}).items():
            described[name] = parameter if isinstance(parameter, Parameter) else Parameter(unit=parameter)

        def define(function: Callable[..., Any]) -> JointFunction:
            graphs = {"pose": _traced(function, [nq], described, _pose)}
            if space:
                graphs["neutral"] = _traced(space["neutral"], [], described, _vector_of("neutral", nq))
                graphs["integrate"] = _traced(space["integrate"], [nq, dofs], described, _vector_of("integrate", nq))
                graphs["difference"] = _traced(space["difference"], [nq, nq], described, _vector_of("difference", dofs))
                graphs["normalize"] = _traced(space["normalize"], [nq], described, _vector_of("normalize", nq))
            if rates is not None:
                graphs["rates"] = _traced(rates, [nq, dofs], described, _vector_of("rates", nq))
            summary = (inspect.getdoc(function) or f"written in Python by {function.__module__}").splitlines()[0]
            schema = [(name, p.unit, p.help, p.size, p.numbers()) for name, p in described.items()]
            traced = _core._TracedJoint(function.__name__, summary, schema, nq, dofs, graphs)
            joint = JointFunction(function, traced, nq, dofs, described)
            self._register(joint, compiled)
            return joint

        return define

    def _register(self, joint: JointFunction, compiled: bool) -> None:
        if compiled:
            try:
                joint.path = joint._traced.compile()
            except Error as error:
                if error.code == "compiler":
                    remedy = f"@libdyn.joint(..., compiled=False) runs the operations of '{joint.name}' one by one, without a compiler"
                    error.args = (f"{error.args[0]}\n  {remedy}",)
                raise
        earlier = self._known.get(joint.name)
        if earlier is None or joint.path is None or joint.path != earlier.path:
            joint._traced.register(joint.path or "", earlier is not None)
        self._known[joint.name] = joint

    def known(self) -> list[JointFunction]:
        """Returns all joint types that were written in Python, in the order of their definition."""
        return list(self._known.values())

    def source(self, joint: JointFunction) -> str:
        """Returns the C++ source of the joint's plugin."""
        return joint._traced.source()

    def export_plugin(self, joint: JointFunction, folder: Union[str, "os.PathLike[str]"]) -> pathlib.Path:
        """Writes a new folder from which CMake builds the joint's plugin, with a robot that has one; returns its path."""
        folder = pathlib.Path(folder).absolute()
        if folder.exists():
            raise FileExistsError(f"{folder} exists already; name a folder that does not")
        making = folder.with_name(f".{folder.name}-{os.getpid()}")
        making.mkdir()
        try:
            for name, text in joint._traced.folder():
                (making / name).write_text(text)
            os.rename(making, folder)  # the folder is there whole or not at all
        except BaseException:
            shutil.rmtree(making, ignore_errors=True)
            raise
        return folder


joint = _Joint()
