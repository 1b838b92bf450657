// SPDX-License-Identifier: BSD-2-Clause
// Centroidal quantities for algorithms that have evaluated the joints.
#pragma once

#include "data/data_impl.hpp"

#include <dyn/algorithm/centroidal.hpp>

namespace dyn::detail {

/// Computes centroidal quantities of a model with mass. The joints must have been evaluated and, for more than the map, the derivatives of their
/// subspaces. v and a are in expanded coordinates.
CentroidalViews centroidalOfEvaluated(const CompactImpl& m, DataImpl& d, Algorithm algorithm, const double* v, const double* a);

}  // namespace dyn::detail
