# SPDX-License-Identifier: BSD-2-Clause
"""Names of Pinocchio's module that are not here, and libdyn's own way to do the same."""

from __future__ import annotations

from typing import NoReturn

_WAYS = {
    "buildModelFromMJCF": "libdyn reads URDF files only; convert the file, or build the model with addJoint",
    "buildModelFromSdf": "libdyn reads URDF files only; convert the file, or build the model with addJoint",
    "buildGeomFromMJCF": "libdyn reads URDF files only",
    "buildGeomFromSdf": "libdyn reads URDF files only",
    "ADMMContactSolver": "libdyn.Simulator solves contacts with friction",
    "PGSContactSolver": "libdyn.Simulator solves contacts with friction",
    "DelassusOperatorDense": "libdyn has DelassusOperator in C++; ContactCholeskyDecomposition gives the Delassus matrix",
    "DelassusOperatorSparse": "libdyn has DelassusOperator in C++; ContactCholeskyDecomposition gives the Delassus matrix",
    "DelassusCholeskyExpression": "libdyn has DelassusOperator in C++; ContactCholeskyDecomposition gives the Delassus matrix",
    "computeDelassusMatrix": "libdyn has computeDelassusMatrix in C++",
    "computeRNEASecondOrderDerivatives": "use libdyn.compute_rnea_second_order_derivatives",
    "getJointKinematicHessian": "libdyn has no kinematic Hessians; differences of Jacobians are exact to about 8 digits",
    "computeJointKinematicHessians": "libdyn has no kinematic Hessians; differences of Jacobians are exact to about 8 digits",
    "getKinematicHessian": "libdyn has no kinematic Hessians; differences of Jacobians are exact to about 8 digits",
    "computeSupportedInertiaByFrame": "add model.inertias of the joints in model.subtrees",
    "computeSupportedForceByFrame": "data.f has the forces that joints transmit",
    "computeCollisionsInParallel": "call computeCollisions in threads of your own, with a GeometryData for each",
    "reachableWorkspaceWithCollisions": "libdyn has no workspaces; sample randomConfiguration",
    "GeometryPool": "use libdyn.BatchData",
    "reachableWorkspace": "libdyn has no workspaces; sample randomConfiguration",
    "reachableWorkspaceHull": "libdyn has no workspaces; sample randomConfiguration",
    "casadi": "libdyn writes CasADi functions: dyn codegen --casadi",
    "cppad": "libdyn has analytical derivatives, and expression graphs in C++ (dyn/codegen)",
    "cppadcg": "libdyn generates code: dyn codegen",
    "mpfr": "libdyn computes in double precision, and batches also in float",
}


class Missing(NotImplementedError, AttributeError):
    """A name of Pinocchio's module that is not here. hasattr() is false for it."""


def find(name: str) -> NoReturn:
    """Raises Missing with libdyn's way for a name of Pinocchio; AttributeError for any other name."""
    if name in _WAYS:
        raise Missing(f"libdyn.pinocchio has no {name}: {_WAYS[name]}")
    raise AttributeError(f"module 'libdyn.pinocchio' has no attribute '{name}'")
