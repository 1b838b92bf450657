// SPDX-License-Identifier: BSD-2-Clause
// Sums over the bodies of a state whose kinematics are in data.
#pragma once

#include "data/data_impl.hpp"

#include <dyn/algorithm/center_of_mass.hpp>

namespace dyn::detail {

CenterOfMass sumCenterOfMass(const CompactImpl& m, DataImpl& d, bool v, bool a);
/// v is in expanded coordinates.
double sumKineticEnergy(const CompactImpl& m, DataImpl& d, const double* v);
double sumPotentialEnergy(const CompactImpl& m, DataImpl& d);

}  // namespace dyn::detail
