# SPDX-License-Identifier: BSD-2-Clause
"""Lists whose elements all have one type, with the names of Pinocchio's vectors."""

from __future__ import annotations

import copy
import operator
from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn

from .inertia import Inertia
from .spatial import SE3, Force, Motion
from .symmetric3 import Symmetric3

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array

__all__ = [
    "StdMap_String_VectorXd",
    "StdVec_Bool",
    "StdVec_Force",
    "StdVec_Index",
    "StdVec_IndexVector",
    "StdVec_Inertia",
    "StdVec_Int",
    "StdVec_MatrixXs",
    "StdVec_Motion",
    "StdVec_SE3",
    "StdVec_Scalar",
    "StdVec_StdString",
    "StdVec_Symmetric3",
    "StdVec_Vector3",
    "StdVec_VectorXb",
    "StdVec_VectorXs",
]


def _equal(a, b):
    return np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b


class TypedList(list):
    """A list that converts what it gets to one type. Elements are the objects themselves: a change of x[0].translation changes x."""

    __hash__ = None

    @staticmethod
    def _convert(x):
        return x

    def __init__(self, *args: Any) -> None:
        if len(args) == 2:
            size, value = operator.index(args[0]), args[1]
            if size < 0:
                raise ValueError(f"size is {size}; it must not be negative")
            room = [None] * size  # a size beyond the memory is an error here, before copies are made
            args = ([copy.deepcopy(value) for _ in room],)
        super().__init__(map(self._convert, *args) if args else ())

    def append(self, x: Any) -> None:
        super().append(self._convert(x))

    def extend(self, items: Iterable[Any]) -> None:
        super().extend([self._convert(x) for x in items])

    def insert(self, index: Any, x: Any) -> None:
        super().insert(index, self._convert(x))

    def __iadd__(self, items: Iterable[Any]) -> Self:
        self.extend(items)
        return self

    def __setitem__(self, index: Any, x: Any) -> None:
        super().__setitem__(index, [self._convert(item) for item in x] if isinstance(index, slice) else self._convert(x))

    def __getitem__(self, index: Any) -> Any:
        out = super().__getitem__(index)
        return type(self)(out) if isinstance(index, slice) else out

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, (list, tuple)):
            return NotImplemented
        return len(self) == len(other) and all(map(_equal, self, other))

    def __ne__(self, other: object) -> bool:
        equal = self.__eq__(other)
        return equal if equal is NotImplemented else not equal

    def tolist(self, deep_copy: bool = False) -> list[Any]:
        """Returns a plain list of the elements, or of copies of them."""
        return copy.deepcopy(list(self)) if deep_copy else list(self)

    def copy(self) -> Self:
        """Returns a list of copies of the elements."""
        return copy.deepcopy(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return type(self)([copy.deepcopy(x, memo) for x in self])

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (list(self),)


def typed_list(name: str, convert: Any, module: Any) -> Any:
    """Makes a TypedList class, which belongs to a module by name. `convert` returns its argument as an element, or raises TypeError."""
    return type(name, (TypedList,), {"_convert": staticmethod(convert), "__module__": module, "__doc__": f"A list of {name[7:]}."})


def instances(cls: Any, base: Any = None) -> Callable[[Any], Any]:
    """Returns a conversion that keeps instances of cls, makes one of instances of `base`, and refuses others."""

    def convert(x):
        if isinstance(x, cls):
            return x
        if base is not None and isinstance(x, base):
            return cls(x)
        raise TypeError(f"an element must be a {cls.__name__}, not {type(x).__name__}")

    return convert


def _text(x):
    if not isinstance(x, str):
        raise TypeError(f"an element must be a str, not {type(x).__name__}")
    return x


def _numbers(dimensions, shape=None, dtype=float):
    def convert(x):
        out = np.array(x, dtype=dtype)
        if out.ndim != dimensions:
            out = out.reshape(-1) if dimensions == 1 and max(out.shape, default=0) == out.size else out
        if out.ndim != dimensions or (shape is not None and out.shape != shape):
            raise ValueError(f"an element has shape {np.shape(x)}; it must have {shape or f'{dimensions} dimensions'}")
        return out

    return convert


StdVec_SE3 = typed_list("StdVec_SE3", instances(SE3, libdyn.SE3), __name__)
StdVec_Motion = typed_list("StdVec_Motion", instances(Motion, libdyn.Motion), __name__)
StdVec_Force = typed_list("StdVec_Force", instances(Force, libdyn.Force), __name__)
StdVec_Inertia = typed_list("StdVec_Inertia", instances(Inertia, libdyn.Inertia), __name__)
StdVec_Symmetric3 = typed_list("StdVec_Symmetric3", instances(Symmetric3), __name__)
StdVec_StdString = typed_list("StdVec_StdString", _text, __name__)
StdVec_Bool = typed_list("StdVec_Bool", bool, __name__)
StdVec_Int = typed_list("StdVec_Int", operator.index, __name__)
StdVec_Index = typed_list("StdVec_Index", operator.index, __name__)
StdVec_Scalar = typed_list("StdVec_Scalar", float, __name__)
StdVec_IndexVector = typed_list("StdVec_IndexVector", StdVec_Index, __name__)
StdVec_Vector3 = typed_list("StdVec_Vector3", _numbers(1, (3,)), __name__)
StdVec_VectorXs = typed_list("StdVec_VectorXs", _numbers(1), __name__)
StdVec_VectorXb = typed_list("StdVec_VectorXb", _numbers(1, dtype=bool), __name__)
StdVec_MatrixXs = typed_list("StdVec_MatrixXs", _numbers(2), __name__)


class StdMap_String_VectorXd(dict):
    """Vectors by name, such as reference configurations. Values become arrays of float64."""

    def __init__(self, *args: Any, **named: Any) -> None:
        super().__init__()
        for name, value in dict(*args, **named).items():
            self[name] = value

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        super().__setitem__(_text(name), _numbers(1)(value))

    def todict(self, deep_copy: bool = False) -> Array:
        """Returns a plain dict of the arrays, or of copies of them."""
        return copy.deepcopy(dict(self)) if deep_copy else dict(self)

    def copy(self) -> Self:
        return copy.deepcopy(self)

    def __deepcopy__(self, memo: Any) -> Self:
        return StdMap_String_VectorXd(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return StdMap_String_VectorXd, (dict(self),)
