# SPDX-License-Identifier: BSD-2-Clause
"""Lists whose elements are made when they are first read, and lists that report changes."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing_extensions import Self


T = TypeVar("T")


class Elements(Generic[T]):
    """A list of fixed length, as Pinocchio's vectors of results. make(k) returns element k when it is first read."""

    def __init__(self, count: int, make: Any = None, items: Any = None) -> None:
        self._items = [None] * count if items is None else items
        self._make = make

    def _place(self, k):
        if isinstance(k, bool) or not isinstance(k, (int, np.integer)):
            raise TypeError("Invalid index type")
        count = len(self._items)
        if not -count <= k < count:
            raise IndexError("Index out of range")
        return k % count

    @overload
    def __getitem__(self, k: int) -> T: ...
    @overload
    def __getitem__(self, k: slice) -> list[T]: ...
    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, slice):
            return [self[i] for i in range(*k.indices(len(self)))]
        k = self._place(k)
        item = self._items[k]
        if item is None:
            item = self._items[k] = self._make(k)
        return item

    def __setitem__(self, k: int, item: T) -> None:
        self._items[self._place(k)] = item

    def __len__(self) -> int:
        return len(self._items)

    def __iter__(self) -> Iterator[T]:
        return (self[k] for k in range(len(self)))

    def tolist(self) -> list[T]:
        """Returns the elements as a list."""
        return list(self)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Elements) and len(self) == len(other) and all(np.all(a == b) for a, b in zip(self, other))

    def __repr__(self) -> str:
        return repr(self.tolist())

    def __getstate__(self) -> Any:
        return {"_items": self.tolist(), "_make": None}

    def __copy__(self) -> Self:
        return Elements(len(self), items=[copy.copy(x) for x in self])

    def __deepcopy__(self, memo: Any) -> Self:
        return self.__copy__()


class Watched(list):
    """A list of a Model, its owner: it tells the owner of each change, and which items it gives away, because their holders may change them.

    owner is a function that returns the Model, or None after its end.
    """

    owner = staticmethod(lambda: None)
    lends = ""

    def __getitem__(self, k: Any) -> Any:
        item = super().__getitem__(k)
        if self.lends and self.owner() is not None:
            for i, x in zip(range(*k.indices(len(self))), item) if isinstance(k, slice) else ((k % len(self), item),):
                self.owner().lend((self.lends, i), x)
        return item

    def __iter__(self) -> Iterator[Any]:
        return (self[k] for k in range(len(self)))

    def __setitem__(self, k: Any, item: Any) -> None:
        super().__setitem__(k, item)
        self._report()

    def append(self, item: Any) -> None:
        super().append(item)
        self._report()

    def tolist(self) -> list[Any]:
        """Returns the elements as a list."""
        return list(self)

    def items(self) -> list[Any]:
        """Returns the elements as a list, for a reader that changes none."""
        return list(list.__iter__(self))

    def _report(self):
        if self.owner() is not None:
            self.owner().changed()

    def __reduce__(self) -> tuple[Any, ...]:
        return Watched, (self.items(),)
