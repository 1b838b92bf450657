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

using DynamicParameters = std::array<double, 10>;      ///< (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) [kg, kg m, kg m^2]
using PseudoInertia = std::array<double, 16>;          ///< [[Sigma, m c], [m c^T, m]], a symmetric 4 x 4 matrix, row after row
using LogCholeskyParameters = std::array<double, 10>;  ///< (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3)

/// Returns the dynamic parameters of an inertia.
DYN_API DynamicParameters toDynamicParameters(const Inertia<double>& Y);
/// Returns the inertia with these dynamic parameters. Throws Error(argument) if the mass is zero but the first moment is not.
DYN_API Inertia<double> inertiaFromDynamicParameters(const DynamicParameters& pi);

/// Returns the pseudo-inertia of a body with these dynamic parameters.
DYN_API PseudoInertia pseudoInertia(const DynamicParameters& pi);
/// Returns the dynamic parameters of a body with this pseudo-inertia, whose upper triangle is read.
DYN_API DynamicParameters dynamicParameters(const PseudoInertia& J);

/// Returns J = U U^T with U = e^alpha [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]].
DYN_API PseudoInertia pseudoInertiaFromLogCholesky(const LogCholeskyParameters& theta);
/// Returns the parameters whose pseudo-inertia is J, whose upper triangle is read. Throws Error(argument) if J is not positive definite.
DYN_API LogCholeskyParameters logCholesky(const PseudoInertia& J);

/// The answer of physicalConsistency().
struct PhysicalConsistency {
  bool consistent;  ///< true if the mass is not negative, and the margin is not negative up to rounding
  double margin;    ///< smallest principal second moment, relative to the largest one by magnitude
};
/// Finds whether a body of positive density can have an inertia. A principal second moment is half the trace of the rotational inertia about the
/// centre of mass, minus a principal moment. The margin is negative where the triangle inequality is violated, and zero for a rod, a disc or a point.
/// With mass zero it is 0 if the rotational inertia is zero, else -1. It is -1 for a negative mass and for numbers that are not finite.
DYN_API PhysicalConsistency physicalConsistency(const Inertia<double>& Y);

}  // namespace dyn
