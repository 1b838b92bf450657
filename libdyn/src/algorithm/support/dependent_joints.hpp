// SPDX-License-Identifier: BSD-2-Clause
// Evaluates couplings at a state, and gives algorithms the values that folding needs.
#pragma once

#include "data/data_impl.hpp"
#include "joint/coordinate.hpp"
#include "kernels/body/dependent_joints.hpp"

namespace dyn {

/// The displacement from neutral of a joint with one degree of freedom. q points to its configuration. Joints whose coordinates add are not called.
inline double coordinateOf(const CompactImpl& m, int body, Coordinates& coordinates, const double* q) {
  const BodyIndex& x = m.index[static_cast<std::size_t>(body)];
  const TypeBatch& batch = m.batches[static_cast<std::size_t>(x.batch)];
  return batch.adds ? *q : coordinates.of(batch.placeOf(x.slot), q);
}
inline void setCoordinate(const CompactImpl& m, int body, Coordinates& coordinates, double value, double* q) {
  const BodyIndex& x = m.index[static_cast<std::size_t>(body)];
  const TypeBatch& batch = m.batches[static_cast<std::size_t>(x.batch)];
  if (batch.adds) {
    *q = value;
  } else {
    coordinates.set(batch.placeOf(x.slot), value, q);
  }
}

/// Writes f and its three derivatives at the master's coordinate. Coupling is PackedCoupling or PackedJointCoupling.
template <class Coupling>
void evaluateCoupling(const CompactImpl& m, const Coupling& c, Coordinates& coordinates, const double* q, double* f) {
  const double x = coordinateOf(m, c.master, coordinates, q + m.index[static_cast<std::size_t>(c.master)].idx_q);
  c.type->evaluate(c.constants.data(), static_cast<int>(c.constants.size()), x, f);
}

/// One state in expanded coordinates, and the derivatives of each coupling by its master's coordinate.
struct ExpandedState {
  double *q, *v, *a, *G, *dG, *ddG;
};
/// Writes `out` from the user's q, v and a. If v is null, out.v and out.a are not written. A null a stands for zeros.
void expand(const CompactImpl& m, const double* q, const double* v, const double* a, const ExpandedState& out);

inline kernels::DependentJoints<double> dependentsOf(const CompactImpl& m, const DataImpl& d) { return {m, d.G, d.dG, d.ddG, d.vx, d.ax}; }

}  // namespace dyn
