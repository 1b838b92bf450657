# SPDX-License-Identifier: BSD-2-Clause
"""Functions on matrices that Pinocchio's module has."""

import numpy as np

__all__ = ["computeLargestEigenvector", "inv", "retrieveLargestEigenvalue"]


def inv(matrix):
    """Returns the inverse of a square matrix. Raises numpy.linalg.LinAlgError if there is none."""
    return np.linalg.inv(matrix)


def computeLargestEigenvector(mat, eigenvector_est=None, max_it=10, rel_tol=1e-8):
    """Returns the eigenvector (n,) of the largest eigenvalue of a symmetric matrix, whose length is the eigenvalue.

    The result is exact to rounding, so the estimate and the bounds on iterations have no influence.
    """
    values, vectors = np.linalg.eigh(mat)
    largest = int(np.argmax(np.abs(values)))
    return abs(values[largest]) * vectors[:, largest]


def retrieveLargestEigenvalue(eigenvector):
    """Returns the eigenvalue of a vector of computeLargestEigenvector."""
    return float(np.linalg.norm(eigenvector))
