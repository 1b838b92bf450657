// Derivatives of the motion of a point fixed to a body, by columns.
#pragma once

#include "algorithm/placement.hpp"

namespace dyn {

/// After computeForwardKinematicsDerivatives: columns of 6 numbers, nvx of them, the user's degrees of freedom first, of velocity by q and v
/// and of acceleration by q, v and a.
void motionDerivatives(const CompactImpl& m, DataImpl& d, const PointOnBody& point, ReferenceFrame reference, double* const columns[5]);

}  // namespace dyn
