// Centroidal quantities for algorithms that have evaluated the joints.
#pragma once

#include "data/data_impl.hpp"

#include <dyn/algorithm/centroidal.hpp>

namespace dyn::detail {

/// Of a model with mass; joints, and for more than the map the derivatives of their subspaces, have been evaluated. v, a: expanded.
CentroidalViews centroidalOfEvaluated(const CompactImpl& m, DataImpl& d, CentroidalTask task, const double* v, const double* a);

}  // namespace dyn::detail
