// The mass matrix for algorithms that factor it.
#pragma once

#include "algorithm/inputs.hpp"

namespace dyn {

/// d.M from joints that have been evaluated; with couplings, G must be in d.
const double* massMatrix(const CompactImpl& m, DataImpl& d);

}  // namespace dyn
