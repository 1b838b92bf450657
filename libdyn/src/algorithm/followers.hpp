// Couplings at a state, and derivatives in expanded coordinates to the user's.
#pragma once

#include "data/data_impl.hpp"
#include "joint/coordinate.hpp"

#include <algorithm>

namespace dyn {

/// f and its three derivatives at the master's coordinate, of a PackedCoupling or a PackedJointCoupling.
template <class Coupling>
void evaluateCoupling(const CompactImpl& m, const Coupling& c, const double* q, double* f) {
  const BodyIndex& master = m.index[static_cast<std::size_t>(c.master)];
  const TypeBatch& batch = m.batches[static_cast<std::size_t>(master.batch)];
  const double x = coordinateOf(*batch.type, batch.constants.data() + master.slot, batch.count, q + master.idx_q);
  c.type->evaluate(c.constants.data(), static_cast<int>(c.constants.size()), x, f);
}

/// Columns, `rows` numbers each, of derivatives by q, v and a of something that depends on these: those of follower k are added to its
/// master's, whose q_t, v_t and a_t it follows with v = G v_t and a = G a_t + G' v_t^2. Followers are folded the last first.
inline void foldColumn(const CompactImpl& m, const DataImpl& d, std::size_t k, std::ptrdiff_t rows, double* by_q, double* by_v, double* by_a) {
  const auto dof = [&](int body) { return static_cast<std::ptrdiff_t>(m.index[static_cast<std::size_t>(body)].idx_v); };
  const std::ptrdiff_t s = rows * dof(m.couplings[k].body), t = rows * dof(m.couplings[k].master);
  const double G = d.G[k], dG = d.dG[k], v = d.vx[dof(m.couplings[k].master)], a = d.ax[dof(m.couplings[k].master)];
  for (std::ptrdiff_t i = 0; i < rows; ++i) {
    by_q[t + i] += G * by_q[s + i] + dG * v * by_v[s + i] + (dG * a + d.ddG[k] * v * v) * by_a[s + i];
    by_v[t + i] += G * by_v[s + i] + 2 * dG * v * by_a[s + i];
    by_a[t + i] += G * by_a[s + i];
  }
}

/// The columns of the user's coordinates, moved to the front.
inline void keepUsersColumns(const CompactImpl& m, std::ptrdiff_t rows, double* columns) {
  for (std::size_t k = 0; k < m.v_of_user.size(); ++k)
    std::copy_n(columns + rows * m.v_of_user[k], rows, columns + rows * static_cast<std::ptrdiff_t>(k));
}

/// Rows and columns of the user's coordinates, of an nvx x nvx matrix.
inline void keepUsersEntries(const CompactImpl& m, const double* expanded, double* user) {
  const std::size_t n = m.v_of_user.size();
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i) user[j * n + i] = expanded[static_cast<std::ptrdiff_t>(m.nvx) * m.v_of_user[j] + m.v_of_user[i]];
}

}  // namespace dyn
