// An inertia as numbers that identification works with, and whether a real body can have it.
//
// Ten-vector pi = (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz), the rotational inertia about the frame's origin: dynamics are linear in
// it. Pseudo-inertia: the 4 x 4 matrix [[Sigma, m c], [m c^T, m]] with Sigma = sum m x x^T (Wensing, Kim and Slotine 2018): a body of
// positive density has a positive definite one. Log-Cholesky parameters: ten numbers without bounds, of which each set is such a body
// (Rucker and Wensing 2022).
#pragma once

#include <dyn/export.hpp>
#include <dyn/spatial/inertia.hpp>

#include <array>

namespace dyn {

using DynamicParameters = std::array<double, 10>;
using PseudoInertia = std::array<double, 16>;          ///< row-major, symmetric
using LogCholeskyParameters = std::array<double, 10>;  ///< (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3)

DYN_API DynamicParameters toDynamicParameters(const Inertia<double>& Y);
/// A mass of zero has no centre: its first moment must be zero, too. Throws Error(argument) otherwise.
DYN_API Inertia<double> inertiaFromDynamicParameters(const DynamicParameters& pi);

DYN_API PseudoInertia pseudoInertia(const DynamicParameters& pi);
DYN_API DynamicParameters dynamicParameters(const PseudoInertia& J);

/// J = U U^T with U = e^alpha [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]].
DYN_API PseudoInertia pseudoInertiaFromLogCholesky(const LogCholeskyParameters& theta);
/// Throws Error(argument) if J is not positive definite.
DYN_API LogCholeskyParameters logCholesky(const PseudoInertia& J);

/// Whether a body of positive density can have it: the smallest principal second moment (half the trace of the rotational inertia about the
/// centre of mass less its largest principal moment), relative to the largest; negative where the triangle inequality does not hold, zero
/// for a rod, a disc or a point. Mass zero: 0 if all is zero, else -1.
struct PhysicalConsistency {
  bool consistent;
  double margin;
};
DYN_API PhysicalConsistency physicalConsistency(const Inertia<double>& Y);

}  // namespace dyn
