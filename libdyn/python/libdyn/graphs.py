# SPDX-License-Identifier: BSD-2-Clause
"""Expression graphs of functions written in Python."""

from typing import Any, Callable

import numpy as np

from . import _core
from .tracing import Tape


def trace_function(function: Callable[..., Any], *sizes: int) -> _core.Graph:
    """Runs a function once on unknown numbers; returns its Graph.

    sizes: of the function's arguments, which are arrays of one dimension. The function uses sin, cos and the like of this package, and returns a
    number or an array. The inputs of the graph are the arguments one after the other, its outputs the entries of the result. Raises Error, with
    the line, where the function decides by the value of an unknown number.
    """
    tape = Tape()
    results = np.ravel(np.asarray(function(*(tape.input(size) for size in sizes)), dtype=object))
    return _core._graph(tape.inputs, tape.nodes, [tape.index(x) for x in results])
