# SPDX-License-Identifier: BSD-2-Clause
"""Factors of the matrix [[-mu, J], [J^T, M]] of motion and constraint forces. libdyn's own constraintDynamics does without them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

from .convert import vector

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from ._types import Array
    from .constraints import RigidConstraintData, RigidConstraintModel
    from .data import Data
    from .model import Model


def _factors(A):
    """Returns U, unit upper triangular, and d with A = U diag(d) U^T, for a symmetric A that is definite. Raises ValueError if A is not."""
    sign = -1.0 if len(A) and A[-1, -1] < 0 else 1.0
    try:
        L = np.linalg.cholesky(sign * A[::-1, ::-1])
    except np.linalg.LinAlgError:
        raise ValueError("ContactCholeskyDecomposition: the mass matrix or the constraints are singular; a positive mu helps the latter") from None
    diagonal = np.diag(L)
    return (L / diagonal)[::-1, ::-1], (sign * diagonal**2)[::-1]


class ContactCholeskyDecomposition:
    """Factors U D U^T of [[-mu, J], [J^T, M]], with J of a list of RigidConstraintModels and M = data.M. compute() makes them."""

    def __init__(self, model: Optional[Model] = None, contact_models: Sequence[RigidConstraintModel] = ()) -> None:
        self._rows, self._contacts = sum(x.size() for x in contact_models), len(contact_models)
        self._nv = 0 if model is None else model.nv
        self._M = self._J = None

    def size(self) -> int:
        """Returns the number of rows of the matrix."""
        return self._rows + self._nv

    def constraintDim(self) -> int:
        """Returns the number of rows of all constraints."""
        return self._rows

    def numContacts(self) -> int:
        """Returns the number of constraints."""
        return self._contacts

    def compute(
        self,
        model: Model,
        data: Data,
        contact_models: Sequence[RigidConstraintModel],
        contact_datas: Sequence[RigidConstraintData],
        mu: float = 0.0,
    ) -> None:
        """Computes the factors with data.M and at the state of the last computeJointJacobians. mu is one number, or one for each row."""
        from .constraints import getConstraintsJacobian

        self._J = getConstraintsJacobian(model, data, contact_models, contact_datas)
        self._M = np.array(data.M)
        self._rows, self._nv, self._contacts = len(self._J), model.nv, len(contact_models)
        self._of_mass = _factors(self._M)
        U, d = self._of_mass
        self._mixed = np.linalg.solve(U, self._J.T).T / d  # rows of constraints in U
        self._free = (self._mixed * d) @ self._mixed.T
        self.updateDamping(mu)

    def updateDamping(self, mu: float) -> None:
        """Computes the factors with another mu."""
        self._mu = np.full(self._rows, float(mu)) if np.ndim(mu) == 0 else vector(mu, self._rows, "updateDamping", "mu")
        self._of_forces = _factors(-(self._free + np.diag(self._mu)))

    @property
    def U(self) -> Array:
        """The unit upper triangular factor."""
        return np.block([[self._of_forces[0], self._mixed], [np.zeros((self._nv, self._rows)), self._of_mass[0]]])

    @property
    def D(self) -> Array:
        """The diagonal factor."""
        return np.concatenate([self._of_forces[1], self._of_mass[1]])

    @property
    def Dinv(self) -> Array:
        """The inverse of D."""
        return 1 / self.D

    def matrix(self) -> Array:
        """Returns the matrix."""
        return np.block([[-np.diag(self._mu), self._J], [self._J.T, self._M]])

    def solve(self, matrix: ArrayLike) -> Array:
        """Returns the solution x of A x = `matrix`, a vector or the columns of a matrix."""
        b = np.asarray(matrix, dtype=float)
        U = self.U
        y = np.linalg.solve(U, b)
        return np.linalg.solve(U.T, (y.T / self.D).T)

    def inverse(self) -> ContactCholeskyDecomposition:
        """Returns the inverse of the matrix."""
        return self.solve(np.eye(self.size()))

    def getInverseOperationalSpaceInertiaMatrix(self) -> Array:
        """Returns the Delassus matrix J M^-1 J^T + mu."""
        return self._free + np.diag(self._mu)

    def getOperationalSpaceInertiaMatrix(self) -> Array:
        """Returns the inverse of the Delassus matrix."""
        return np.linalg.inv(self.getInverseOperationalSpaceInertiaMatrix())

    def getInverseMassMatrix(self) -> Array:
        """Returns M^-1."""
        return np.linalg.inv(self._M)
