// Couplings at a state: evaluated, and what algorithms fold with.
#pragma once

#include "data/data_impl.hpp"
#include "joint/coordinate.hpp"
#include "kernels/followers.hpp"

namespace dyn {

/// How far a joint of one degree of freedom, whose configuration is where q begins, is from neutral. Joints whose coordinates add are not asked.
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

/// f and its three derivatives at the master's coordinate, of a PackedCoupling or a PackedJointCoupling.
template <class Coupling>
void evaluateCoupling(const CompactImpl& m, const Coupling& c, Coordinates& coordinates, const double* q, double* f) {
  const double x = coordinateOf(m, c.master, coordinates, q + m.index[static_cast<std::size_t>(c.master)].idx_q);
  c.type->evaluate(c.constants.data(), static_cast<int>(c.constants.size()), x, f);
}

/// One state in expanded coordinates, and derivatives of each coupling by its master's.
struct ExpandedState {
  double *q, *v, *a, *G, *dG, *ddG;
};
/// From the user's; v may be null, which writes neither v nor a, and a may be, for zeros.
void expand(const CompactImpl& m, const double* q, const double* v, const double* a, const ExpandedState& out);

inline kernels::Followers<double> followersOf(const CompactImpl& m, const DataImpl& d) { return {m, d.G, d.dG, d.ddG, d.vx, d.ax}; }

}  // namespace dyn
