// The mass matrix for algorithms that factor it.
#pragma once

#include "algorithm/inputs.hpp"

namespace dyn {

/// d.M, at inputs that have been read last.
const double* massMatrix(const CompactImpl& m, DataImpl& d, const Inputs& in);

}  // namespace dyn
