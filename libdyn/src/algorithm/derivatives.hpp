// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of inverse dynamics and M^-1, for other algorithms.
#pragma once

#include "data/data_impl.hpp"

namespace dyn {

/// Writes the derivatives of rnea(q, v, a) by q and v to d.dtau_dq and d.dtau_dv, as computeRNEADerivatives gives them. With couplings, or if with_M,
/// also writes M to d.M. Null v or a stand for zeros. Throws Error(size | argument).
void forceDerivatives(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                      const Force<double>* fext, std::size_t count, bool with_M = false);

/// Writes M^-1 to d.Minv, for a model without couplings whose joints have been evaluated at q. Throws Error(singular).
void invertTreeInertia(const char* algorithm, const CompactImpl& m, DataImpl& d, const double* q);
/// Writes M^-1 to d.Minv. Without couplings, the joints must have been evaluated at q, for example by forceDerivatives. Throws Error(singular).
void inverseInertia(const char* algorithm, const CompactModel& model, Data& data, VectorView q);

}  // namespace dyn
