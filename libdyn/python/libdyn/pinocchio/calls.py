# SPDX-License-Identifier: BSD-2-Clause
"""The first step of every algorithm: its model, compiled, and libdyn's data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .compiled import Compiled
    from .data import Data
    from .model import Model


def compiled(model: Model, function: str) -> Compiled:
    """Returns the Compiled of a model. Raises TypeError for another object."""
    try:
        return model.compiled()
    except AttributeError:
        from .model import Model

        if isinstance(model, Model):
            raise
        raise TypeError(f"{function}: model must be a Model, not {type(model).__name__}") from None


def prepare(model: Model, data: Data, function: str) -> tuple[Compiled, Any]:
    """Returns the Compiled of a model and libdyn's data in `data`. Raises TypeError for other objects, ValueError for data of other sizes."""
    c = compiled(model, function)
    try:
        return c, data.use(c, function)
    except AttributeError:
        from .data import Data

        if isinstance(data, Data):
            raise
        raise TypeError(f"{function}: data must be a Data, not {type(data).__name__}") from None
