// SPDX-License-Identifier: BSD-2-Clause
// Reduces results in expanded coordinates, which include those of dependent joints, to the user's coordinates.
#pragma once

#include "compile/compact_impl.hpp"

#include <algorithm>

namespace dyn::kernels {

/// The couplings at one state. A dependent joint has v = G v_t and a = G a_t + G' v_t^2, where t is its master's degree of freedom. The entries of
/// a dependent joint are added to its master's. A master may itself depend on another joint, so the last coupling goes first. S is a number or a
/// pack of states. Matrices have one column per degree of freedom, of nvx or of `rows` numbers.
template <class S>
struct DependentJoints {
  const CompactImpl& m;
  const S *G, *dG, *ddG;  ///< one per coupling: dq_s/dq_t and its first two derivatives by the master's coordinate q_t
  const S *v, *a;         ///< in expanded coordinates

  /// G^T x for forces, J G for a matrix of columns.
  void fold(std::ptrdiff_t rows, S* x) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) { addTo(rows, x + rows * t, G[k], x + rows * s); });
  }
  void foldForces(S* tau) const { fold(1, tau); }
  /// J G and its time derivative.
  void foldWithRate(std::ptrdiff_t rows, S* x, S* rate) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) { foldRate(k, rows, s, t, x, rate); });
  }
  /// Derivatives by q, v and a of a quantity that depends on these.
  void foldDerivatives(std::ptrdiff_t rows, S* by_q, S* by_v, S* by_a) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) { foldDerivativesOf(k, rows, s, t, by_q, by_v, by_a); });
  }
  /// Folds those CentroidalMaps that are wanted, and keeps the columns of the user's coordinates only.
  template <class Maps>
  void foldMaps(const Maps& maps) const {
    if (maps.dhdot_dq != nullptr) {
      foldMomentum(maps.dh_dq, maps.dhdot_dq, maps.dhdot_dv, maps.Ag);
    } else if (maps.dAg != nullptr) {
      foldWithRate(6, maps.Ag, maps.dAg);
    } else {
      fold(6, maps.Ag);
    }
    for (S* columns : {maps.Ag, maps.dAg, maps.dh_dq, maps.dhdot_dq, maps.dhdot_dv})
      if (columns != nullptr) keep(6, columns, columns);
  }
  /// G^T M G.
  void foldInertia(S* M) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) {
      addTo(m.nvx, M + m.nvx * t, G[k], M + m.nvx * s);
      foldRow(k, s, t, M);
    });
  }
  /// G^T (C G + M dG/dt) in C, and G^T M G in M.
  void foldCoriolis(S* C, S* M) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) {
      foldRate(k, m.nvx, s, t, M, C);
      for (S* x : {C, M}) foldRow(k, s, t, x);
    });
  }
  /// Derivatives of forces tau, which have been folded before. Columns and rows are folded. dG tau_s is added, because G also maps the dependent
  /// joint's force to its master's, and changes with q_t.
  void foldForceDerivatives(const S* tau, S* by_q, S* by_v, S* by_a) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) {
      foldDerivativesOf(k, m.nvx, s, t, by_q, by_v, by_a);
      for (S* x : {by_q, by_v, by_a}) foldRow(k, s, t, x);
      by_q[t * m.nvx + t] += dG[k] * tau[s];
    });
  }

  /// Computes the expanded accelerations from the user's.
  void follow(const S* user, S* expanded) const {
    for (std::size_t k = 0; k < m.v_of_user.size(); ++k) expanded[m.v_of_user[k]] = user[k];
    for (std::size_t k = 0; k < m.couplings.size(); ++k) {
      const int s = dofOf(m.couplings[k].body), t = dofOf(m.couplings[k].master);
      expanded[s] = G[k] * expanded[t] + dG[k] * v[t] * v[t];
    }
  }

  /// Copies the columns of the user's coordinates to `to`, side by side. `to` may be x.
  void keep(std::ptrdiff_t rows, const S* x, S* to) const {
    for (const int dof : m.v_of_user) to = std::copy_n(x + rows * dof, rows, to);
  }
  /// Copies the rows and columns of the user's coordinates from a matrix of nvx x nvx numbers.
  void keepSquare(const S* x, S* to) const {
    for (const int column : m.v_of_user)
      for (const int row : m.v_of_user) *to++ = x[static_cast<std::ptrdiff_t>(m.nvx) * column + row];
  }

 private:
  /// Calls use(k, dof of the dependent joint, dof of its master) for each coupling k, the last one first.
  template <class Use>
  void lastFirst(Use&& use) const {
    for (std::size_t k = m.couplings.size(); k-- > 0;)
      use(k, std::ptrdiff_t{dofOf(m.couplings[k].body)}, std::ptrdiff_t{dofOf(m.couplings[k].master)});
  }
  /// Folds the derivative of a momentum by q, the derivatives of its rate by q and v, and the map itself.
  void foldMomentum(S* h_by_q, S* rate_by_q, S* rate_by_v, S* map) const {
    lastFirst([&](std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t) {
      addTo(6, h_by_q + 6 * t, G[k], h_by_q + 6 * s);
      addTo(6, h_by_q + 6 * t, dG[k] * v[t], map + 6 * s);
      foldDerivativesOf(k, 6, s, t, rate_by_q, rate_by_v, map);
    });
  }
  int dofOf(int body) const { return m.index[static_cast<std::size_t>(body)].idx_v; }
  static void addTo(std::ptrdiff_t rows, S* x, const S& scale, const S* y) {
    for (std::ptrdiff_t i = 0; i < rows; ++i) x[i] += scale * y[i];
  }
  void foldRate(std::size_t k, std::ptrdiff_t rows, std::ptrdiff_t s, std::ptrdiff_t t, S* x, S* rate) const {
    addTo(rows, rate + rows * t, G[k], rate + rows * s);
    addTo(rows, rate + rows * t, dG[k] * v[t], x + rows * s);
    addTo(rows, x + rows * t, G[k], x + rows * s);
  }
  void foldDerivativesOf(std::size_t k, std::ptrdiff_t rows, std::ptrdiff_t s, std::ptrdiff_t t, S* by_q, S* by_v, S* by_a) const {
    const S rate = dG[k] * v[t], change = dG[k] * a[t] + ddG[k] * v[t] * v[t];
    for (std::ptrdiff_t i = 0; i < rows; ++i) {
      S &of_q = by_q[rows * t + i], &of_v = by_v[rows * t + i], &of_a = by_a[rows * t + i];
      const S &q_projection = by_q[rows * s + i], &v_projection = by_v[rows * s + i], &a_share = by_a[rows * s + i];
      of_q += G[k] * q_projection + rate * v_projection + change * a_share;
      of_v += G[k] * v_projection + S(2) * rate * a_share;
      of_a += G[k] * a_share;
    }
  }
  void foldRow(std::size_t k, std::ptrdiff_t s, std::ptrdiff_t t, S* square) const {
    for (std::ptrdiff_t j = 0; j < m.nvx; ++j) square[j * m.nvx + t] += G[k] * square[j * m.nvx + s];
  }
};

}  // namespace dyn::kernels
