// SPDX-License-Identifier: BSD-2-Clause
// Derivatives, factors and centroidal quantities of batches of states.
#pragma once

#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/body/scratch.hpp"
#include "kernels/derivative/aba_derivatives.hpp"
#include "kernels/derivative/centroidal.hpp"
#include "kernels/derivative/coriolis.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"
#include "kernels/derivative/tree_factors.hpp"
#include "kernels/isa/block.hpp"
#include "kernels/isa/coupled_derivatives.hpp"
#include "kernels/pack/columns.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Computes centroidal quantities. The joints must have been evaluated before.
template <class S>
void runCentroidal(const CompactImpl& m, BlockScratch<S>& s, const Block<Real<S>>& b, const Results<S>& results) {
  const std::ptrdiff_t n = 6 * static_cast<std::ptrdiff_t>(m.nv);
  CentroidalMaps<S> maps;
  maps.Ag = s.maps[0];
  if (b.algorithm == Algorithm::centroidal_rate) maps.dAg = s.maps[1];
  if (b.algorithm == Algorithm::centroidal_derivatives) {
    maps.dh_dq = s.maps[2];
    maps.dhdot_dq = s.maps[3];
    maps.dhdot_dv = s.maps[4];
  }
  if (maps.rates()) evaluateSubspaceDerivatives(m, s.d, s.q, s.v);
  const CentroidalState<S> state = kernels::centroidal<S>(m, s.w, s.d, s.v, s.a, maps);
  if (!m.couplings.empty()) s.coupled.dependents(m, s.v, s.a).foldMaps(maps);
  if (b.algorithm == Algorithm::center_of_mass_jacobian) {
    // The linear momentum is the mass times the centre's velocity.
    const S share = S(1) / state.mass;
    for (int k = 0; k < m.nv; ++k)
      for (int c = 0; c < 3; ++c) maps.Ag[3 * k + c] = share * maps.Ag[6 * k + c];
    return results.put(0, maps.Ag, n / 2);
  }
  if (b.algorithm == Algorithm::centroidal_derivatives) {
    for (int k = 0; k < 3; ++k) results.put(k, s.maps[2 + k], n);
    return results.put(3, s.maps[0], n);
  }
  results.put(0, reinterpret_cast<const S*>(&state.momentum), 6);
  if (b.algorithm == Algorithm::centroidal_map) return results.put(1, s.maps[0], n);
  results.put(1, reinterpret_cast<const S*>(&state.rate), 6);
  results.put(2, s.maps[0], n);
  results.put(3, s.maps[1], n);
}

template <class S>
void runDerivatives(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b) {
  Workspace<S>& w = s.w;
  DerivativeWorkspace<S>& d = s.d;
  const std::ptrdiff_t n = m.nvx;
  const Results<S> results(b);
  if (!m.couplings.empty() && !isCentroidal(b.algorithm) && b.algorithm != Algorithm::center_of_mass_jacobian)
    return runCoupledDerivatives(m, s, b, results);
  using Pairs = PathPairs<S>;
  // Squares, if there are any, go directly into the states' matrices.
  const auto putOnPaths = [&](int result, [[maybe_unused]] const PathMatrix<S>& from, [[maybe_unused]] typename Pairs::Number below) {
    if constexpr (in_pairs<S>) {
      const Squares<S>& squares = s.squares.pairs[below];
      if (!squares.empty()) return results.putSquares(result, squares, d.pairs.begin(), n * n);
      d.pairs.expand(m, below, s.matrix);
    } else {
      std::fill(s.matrix, s.matrix + n * n, S(0));
      from.template assemble<S>(m.dof_end, Rows<S>{s.matrix, n});
    }
    results.put(result, s.matrix, n * n);
  };
  const auto putInverse = [&](int result) {
    inverseOfMassMatrix(m, d.factors, s.product, Rows<S>{s.matrix, n});
    if (s.squares.inverse.empty()) {
      mirrorUpper<S>(Rows<S>{s.matrix, n}, m.nvx);
      results.put(result, s.matrix, n * n);
    } else {
      results.putSquares(result, s.squares.inverse, s.matrix, n * n);
    }
    results.putFailures(w.failed);
  };
  // Writes results 0 and 1: derivatives of the acceleration by q and v.
  const auto putAccelerations = [&] {
    if constexpr (in_pairs<S>) {
      accelerationsBy(m, d, s.product, s.columns,
                      [&](int result, int begin, int count) { results.putPart(result, s.columns, count * n, begin * n, n * n); });
    } else {
      for (const int result : {0, 1}) {
        accelerationBy<S>(m, d.factors, result == 0 ? d.by_q : d.by_v, Rows<S>{s.matrix, n});
        results.put(result, s.matrix, n * n);
      }
    }
  };
  switch (b.algorithm) {
    case Algorithm::rnea_derivatives:
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      rneaDerivatives<S>(m, w, d, s.v, s.a);
      putOnPaths(0, d.by_q, Pairs::q_lower);
      putOnPaths(1, d.by_v, Pairs::v_lower);
      putOnPaths(2, d.by_a, Pairs::by_a);
      return;
    case Algorithm::aba_derivatives:
      addDissipation(m, -1.0, s.v, s.a);
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      abaDerivativesSweep<S>(recursion(m, w, d), w, d, s.v, s.a, s.result);
      results.put(3, s.result, n);
      putInverse(2);
      return putAccelerations();
    case Algorithm::minverse:
      treeFactors<S>(m, w, d);
      return b.factors ? results.keep(m, d.factors, w.failed) : putInverse(0);
    case Algorithm::coriolis:
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      std::fill(s.a, s.a + n, S(0));
      coriolisMatrix<S>(m, w, d, s.v, s.a);
      return putOnPaths(0, d.by_v, Pairs::v_lower);
    default:
      return runCentroidal(m, s, b, results);
  }
}

}  // namespace dyn::kernels
