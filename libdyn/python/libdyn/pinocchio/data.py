# SPDX-License-Identifier: BSD-2-Clause
"""Results of algorithms. An algorithm stores what it returns, and notes its state; other fields are computed when a program reads them."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn as dyn

from .elements import Elements
from .inertia import Inertia
from .serialization import Serializable
from .spatial import SE3, Force, Motion
from .state import State, Workspace

if TYPE_CHECKING:
    from typing_extensions import Self

    from ._types import Array
    from .compiled import Compiled
    from .contact_cholesky import ContactCholeskyDecomposition
    from .joint_data import JointData
    from .model import Model

# Values of fields before an algorithm has run.
_OF_JOINTS = {
    **dict.fromkeys(("oMi", "liMi"), SE3.Identity),
    **dict.fromkeys(("v", "a", "ov", "oa", "a_gf", "oa_gf"), Motion.Zero),
    **dict.fromkeys(("f", "of", "h", "oh"), Force.Zero),
    **dict.fromkeys(("Ycrb", "oYcrb"), Inertia.Zero),
    **dict.fromkeys(("com", "vcom", "acom"), lambda: np.zeros(3)),
    "mass": lambda: 0.0,
}
_ARRAYS = {
    **dict.fromkeys(("tau", "nle", "g", "ddq", "dq_after"), ("nv",)),
    **dict.fromkeys(("M", "Minv", "C", "dtau_dq", "dtau_dv", "ddq_dq", "ddq_dv", "ddq_dtau"), ("nv", "nv")),
    **dict.fromkeys(("J", "dJ", "Ag", "dAg"), (6, "nv")),
    "Jcom": (3, "nv"),
    **dict.fromkeys(("lambda_c", "impulse_c"), (0,)),
}
_NUMBERS = ("kinetic_energy", "potential_energy", "mechanical_energy")


class Data(Serializable):
    """Memory for the results of one Model, for one thread. Fields have Pinocchio's names; lists have one entry for each joint or frame."""

    if TYPE_CHECKING:
        oMi: Elements[SE3]
        liMi: Elements[SE3]
        oMf: Elements[SE3]
        v: Elements[Motion]
        a: Elements[Motion]
        ov: Elements[Motion]
        oa: Elements[Motion]
        a_gf: Elements[Motion]
        oa_gf: Elements[Motion]
        f: Elements[Force]
        of: Elements[Force]
        h: Elements[Force]
        oh: Elements[Force]
        Ycrb: Elements[Inertia]
        oYcrb: Elements[Inertia]
        com: Elements[Array]
        vcom: Elements[Array]
        acom: Elements[Array]
        mass: Elements[float]
        joints: Elements[JointData]
        tau: Array
        nle: Array
        g: Array
        ddq: Array
        dq_after: Array
        lambda_c: Array
        impulse_c: Array
        D: Array
        M: Array
        Minv: Array
        C: Array
        dtau_dq: Array
        dtau_dv: Array
        ddq_dq: Array
        ddq_dv: Array
        ddq_dtau: Array
        J: Array
        dJ: Array
        Ag: Array
        dAg: Array
        Jcom: Array
        U: Array
        dlambda_dq: Array
        dlambda_dv: Array
        dlambda_dtau: Array
        jointTorqueRegressor: Array
        staticRegressor: Array
        kineticEnergyRegressor: Array
        potentialEnergyRegressor: Array
        contact_chol: ContactCholeskyDecomposition
        kinetic_energy: float
        potential_energy: float
        mechanical_energy: float
        hg: Force
        dhg: Force
        Ig: Inertia

    def __init__(self, model: Model) -> None:
        self._model = model
        self.sizes = (model.nq, model.nv, model.njoints)
        self._sources = {}
        self._compiled = None

    def use(self, compiled: Compiled, function: str) -> Any:
        """Returns libdyn's data for a compiled model. Raises ValueError if the model has grown since the Data was made."""
        if self._compiled is not compiled:
            if self.sizes != (compiled.nq, compiled.nv, compiled.njoints):
                raise ValueError(f"{function}: data has other sizes than the model; make it anew with model.createData()")
            self._compiled, self._dyn, self._workspace = compiled, dyn.Data(compiled.model), Workspace(compiled)
        return self._dyn

    def state(self, q: Any, v: Any = None, a: Any = None, fext: Any = None) -> State:
        """Returns the state of a call, whose arguments are in libdyn's order."""
        return State(self._compiled, self._workspace, q, v, a, fext)

    def note(self, names: Any, state: State) -> None:
        """Makes `state` the source of fields, which are computed when they are read."""
        for name in names:
            self.__dict__.pop(name, None)
            self._sources[name] = (state, name)

    def note_as(self, name: str, state: State, method: str) -> None:
        """Makes another method of a state the source of a field."""
        self.__dict__.pop(name, None)
        self._sources[name] = (state, method)

    def source(self, field: str, function: str, before: str) -> State:
        """Returns the state from which a field comes. Raises ValueError, which says what to call before, if there is none."""
        if field not in self._sources:
            raise ValueError(f"{function}: call {before} first")
        return self._sources[field][0]

    if not TYPE_CHECKING:  # type checkers know the fields that there are

        def __getattr__(self, name):
            if name.startswith("_"):
                raise AttributeError(name)
            if name in self._sources:
                state, method = self._sources[name]
                value = getattr(state, method)()
            else:
                value = self._unset(name)
            self.__dict__[name] = value
            return value

    def _unset(self, name):
        """Returns a field before any algorithm has run."""
        nq, nv, njoints = self.sizes
        if name in _OF_JOINTS:
            return Elements(njoints, lambda _: _OF_JOINTS[name]())
        if name in _ARRAYS:
            return np.zeros([nv if size == "nv" else size for size in _ARRAYS[name]])
        if name in _NUMBERS:
            return 0.0
        if name == "oMf":
            return Elements(self._model.nframes, lambda _: SE3.Identity())
        if name == "joints":
            return Elements(njoints, lambda k: self._model.joints[k].createData())
        if name in ("hg", "dhg"):
            return Force.Zero()
        if name == "Ig":
            return Inertia.Zero()
        if name in ("U", "D"):
            return self._factors()[name]
        raise AttributeError(f"Data has no field '{name}'; libdyn/doc/pinocchio.md lists those that it has")

    def _factors(self):
        """Returns the factors of M = U D U^T of the last cholesky.decompose."""
        if self._compiled is None:
            nv = self.sizes[1]
            return {"U": np.eye(nv), "D": np.zeros(nv)}
        c = self._compiled
        eye = np.eye(c.nv)
        U = dyn.cholesky.Uv(c.model, self._dyn, eye)
        M = dyn.cholesky.Mv(c.model, self._dyn, eye)
        half = np.linalg.solve(U, np.linalg.solve(U, M).T)
        return {"U": c.square_out(U), "D": c.rows_out(np.diag(half))}

    def fields(self) -> dict[str, Any]:
        """Returns a dictionary of all fields that have been set or read."""
        names = {*self._sources, *(name for name in self.__dict__ if not name.startswith("_") and name != "sizes")}
        return {name: getattr(self, name) for name in sorted(names)}

    def copy(self) -> Data:
        """Returns a copy."""
        other = Data(self._model)
        for name, value in self.fields().items():
            other.__dict__[name] = copy.deepcopy(value)
        if self._compiled is not None:
            other.use(self._compiled, "copy")
            other._sources = {name: (state.moved(other._workspace), method) for name, (state, method) in self._sources.items()}
        return other

    def __copy__(self) -> Self:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Self:
        return self.copy()

    def __getstate__(self) -> Any:
        return {"model": self._model, "fields": self.fields()}

    def __setstate__(self, state: Any) -> None:
        self.__init__(state["model"])
        self.__dict__.update(state["fields"])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Data):
            return NotImplemented
        mine, theirs = self.fields(), other.fields()
        return self.sizes == other.sizes and all(
            np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b
            for a, b in ((getattr(self, name), getattr(other, name)) for name in {**mine, **theirs})
        )

    __hash__ = object.__hash__
