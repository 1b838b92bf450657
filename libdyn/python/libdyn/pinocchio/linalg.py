# SPDX-License-Identifier: BSD-2-Clause
"""Functions on matrices that Pinocchio's module has."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array

__all__ = ["computeLargestEigenvector", "inv", "retrieveLargestEigenvalue"]


def inv(matrix: ArrayLike) -> Array:
    """Returns the inverse of a square matrix. Raises numpy.linalg.LinAlgError if there is none."""
    return np.linalg.inv(matrix)


def computeLargestEigenvector(mat: ArrayLike, eigenvector_est: Optional[ArrayLike] = None, max_it: int = 10, rel_tol: float = 1e-8) -> Array:
    """Returns the eigenvector (n,) of the largest eigenvalue of a symmetric matrix, whose length is the eigenvalue.

    The result is exact to rounding, so the estimate and the bounds on iterations have no influence.
    """
    values, vectors = np.linalg.eigh(mat)
    largest = int(np.argmax(np.abs(values)))
    return abs(values[largest]) * vectors[:, largest]


def retrieveLargestEigenvalue(eigenvector: ArrayLike) -> float:
    """Returns the eigenvalue of a vector of computeLargestEigenvector."""
    return float(np.linalg.norm(eigenvector))
