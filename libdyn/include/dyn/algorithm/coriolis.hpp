// SPDX-License-Identifier: BSD-2-Clause
// The Coriolis matrix.
#pragma once

#include <dyn/data/data.hpp>

namespace dyn {

namespace detail {
DYN_API const double* coriolisMatrix(const CompactModel&, Data&, VectorView q, VectorView v);
}

/// Computes the Coriolis matrix C(q, v), nv x nv. C v + g is nonLinearEffects without dissipation, and dM/dt - 2 C is skew-symmetric. O(n depth).
/// Needs Need::derivatives. Echeandia and Wensing 2021, in the axes of the floating base, or the world, with the origin at each joint. Throws
/// Error(size | argument).
inline MatrixResult computeCoriolisMatrix(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  return {detail::coriolisMatrix(model, data, q, v), model.nv(), model.nv()};
}

}  // namespace dyn
