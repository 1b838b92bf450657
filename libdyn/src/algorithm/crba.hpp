// The mass matrix for algorithms that factor it.
#pragma once

#include "algorithm/inputs.hpp"

namespace dyn {

/// d.M, at inputs that have been read last.
const double* massMatrix(const CompactImpl& m, DataImpl& d, const Inputs& in);
/// Of a model with couplings, whose inputs have been read: kernels::factorDense() of M. Throws Error(singular).
void factorInertia(const char* algorithm, const CompactImpl& m, const DataImpl& d, double* M, double* diagonal);

}  // namespace dyn
