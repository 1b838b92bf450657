// SPDX-License-Identifier: BSD-2-Clause
// The joint-space mass matrix by the composite-rigid-body algorithm.
#pragma once

#include <dyn/data/data.hpp>

namespace dyn {

namespace detail {
DYN_API const double* crba(const CompactModel&, Data&, VectorView q);
}

/// Computes the mass matrix M(q), nv x nv. Both triangles are filled; the diagonal includes armature. Needs Need::mass_matrix. O(n depth).
/// Featherstone 2008, table 6.2, in the axes of the floating base, or the world, with the origin at each joint. Throws Error(size | argument).
inline MatrixResult crba(const CompactModel& model, Data& data, const VectorArg& q) { return {detail::crba(model, data, q), model.nv(), model.nv()}; }

}  // namespace dyn
