// SPDX-License-Identifier: BSD-2-Clause
// Parameters of an inertia for identification, and a check whether a real body can have it.
//
// The ten dynamic parameters pi = (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) have the rotational inertia about the frame's origin. The
// dynamics are linear in pi. The pseudo-inertia is the 4 x 4 matrix [[Sigma, m c], [m c^T, m]] with Sigma = sum m x x^T (Wensing, Kim and Slotine
// 2018). It is positive definite for a body of positive density. The ten log-Cholesky parameters have no bounds: all their values describe such a
// body (Rucker and Wensing 2022).
#pragma once

#include <dyn/export.hpp>
#include <dyn/spatial/inertia.hpp>

#include <array>

namespace dyn {

using DynamicParameters = std::array<double, 10>;
using PseudoInertia = std::array<double, 16>;          ///< row-major, symmetric
using LogCholeskyParameters = std::array<double, 10>;  ///< (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3)

DYN_API DynamicParameters toDynamicParameters(const Inertia<double>& Y);
/// Throws Error(argument) if the mass is zero but the first moment is not.
DYN_API Inertia<double> inertiaFromDynamicParameters(const DynamicParameters& pi);

DYN_API PseudoInertia pseudoInertia(const DynamicParameters& pi);
DYN_API DynamicParameters dynamicParameters(const PseudoInertia& J);

/// J = U U^T with U = e^alpha [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]].
DYN_API PseudoInertia pseudoInertiaFromLogCholesky(const LogCholeskyParameters& theta);
/// Throws Error(argument) if J is not positive definite.
DYN_API LogCholeskyParameters logCholesky(const PseudoInertia& J);

/// Whether a body of positive density can have an inertia. The margin is the smallest principal second moment (half the trace of the rotational
/// inertia about the centre of mass, minus its largest principal moment), relative to the largest second moment. The margin is negative where the
/// triangle inequality is violated, and zero for a rod, a disc or a point. With mass zero it is 0 if the whole inertia is zero, else -1.
struct PhysicalConsistency {
  bool consistent;  ///< the mass is not negative, and the margin is not negative up to rounding
  double margin;
};
DYN_API PhysicalConsistency physicalConsistency(const Inertia<double>& Y);

}  // namespace dyn
