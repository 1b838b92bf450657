// What others take of derivatives and their factors.
#pragma once

#include "data/data_impl.hpp"

namespace dyn {

/// Of rnea(q, v, a) by q and v, as computeRNEADerivatives has them, into d.dtau_dq and d.dtau_dv; with couplings, or if asked for, M
/// into d.M. Throws Error(size | argument).
void forceDerivatives(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                      const Force<double>* fext, std::size_t count, bool with_M = false);

/// M^-1 into d.Minv, of a model without couplings, by the poses of joints that were asked last, at q. Throws Error(singular).
void invertTreeInertia(const char* algorithm, const CompactImpl& m, DataImpl& d, const double* q);
/// M^-1 into d.Minv, at the q that forceDerivatives was asked at last. Throws Error(singular).
void inverseInertia(const char* algorithm, const CompactModel& model, Data& data, VectorView q);

}  // namespace dyn
