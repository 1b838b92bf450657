// SPDX-License-Identifier: BSD-2-Clause
// The mass matrix for algorithms that factor it.
#pragma once

#include "algorithm/support/inputs.hpp"

namespace dyn {

/// Computes and returns d.M. `in` must be the inputs that were read last.
const double* massMatrix(const CompactImpl& m, DataImpl& d, const Inputs& in);
/// Factors M by kernels::factorDense(), for a model with couplings whose inputs have been read. Throws Error(singular).
void factorInertia(const char* algorithm, const CompactImpl& m, const DataImpl& d, double* M, double* diagonal);

}  // namespace dyn
