# SPDX-License-Identifier: BSD-2-Clause
"""Types in the signatures of this package. Only type checkers import them."""
from __future__ import annotations

import os
from typing import TypeVar, Union

import numpy as np
from numpy.typing import NDArray

from .inertia import Inertia
from .spatial import SE3, Force, Motion

Array = NDArray[np.float64]
Path = Union[str, "os.PathLike[str]"]
# A pose maps each of these to the same type: a motion gives a motion.
Acted = TypeVar("Acted", SE3, Motion, Force, Inertia, Array)
