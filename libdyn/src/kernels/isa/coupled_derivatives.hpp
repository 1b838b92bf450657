// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of blocks of states of models with couplings, after CoupledBlock::beforeDerivatives(). Expanded matrices are folded to the user's.
#pragma once

#include "kernels/derivative/coriolis.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"
#include "kernels/isa/block.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <algorithm>
#include <array>

namespace dyn::kernels {

template <class S>
class CoupledDerivatives {
 public:
  CoupledDerivatives(const CompactImpl& m, BlockScratch<S>& s) : m_(m), s_(s), dependents_(s.coupled.dependents(m, s.v, s.a)) {}

  /// Returns the derivatives of rnea by q, v and a, in the user's coordinates. rneaDerivatives() must have run before.
  std::array<S*, 3> ofForces() {
    const std::array<S*, 3> x{expanded(s_.d.by_q, Pairs::q_lower, 0), expanded(s_.d.by_v, Pairs::v_lower, 1), expanded(s_.d.by_a, Pairs::by_a, 2)};
    dependents_.foldForceDerivatives(s_.coupled.tau, x[0], x[1], x[2]);
    for (S* matrix : x) dependents_.keepSquare(matrix, matrix);
    return x;
  }
  /// Replaces x by -M^-1 x.
  void toAccelerations(S* x) const {
    const std::ptrdiff_t n = m_.nv;
    for (std::ptrdiff_t k = 0; k < n; ++k) solveDense(m_, s_.coupled.M, x + n * k);
    for (std::ptrdiff_t i = 0; i < n * n; ++i) x[i] = -x[i];
  }
  S* inverse() {
    invertDense(m_, s_.coupled.M, s_.matrix);
    return s_.matrix;
  }
  /// Returns the Coriolis matrix in the user's coordinates. coriolisMatrix() must have left the expanded one in s.d.by_v.
  S* coriolis() {
    S* C = expanded(s_.d.by_v, Pairs::v_lower, 1);
    dependents_.foldCoriolis(C, s_.M);
    s_.coupled.clear(m_, s_.M);
    dependents_.keepSquare(C, C);
    return C;
  }

 private:
  using Pairs = PathPairs<S>;
  S* expanded(const PathMatrix<S>& from, typename Pairs::Number below, std::size_t k) {
    S* to = s_.coupled.expanded[k];
    if constexpr (in_pairs<S>) {
      s_.d.pairs.expand(m_, below, to);
    } else {
      s_.coupled.clear(m_, to);
      from.template assemble<S>(m_.dof_end, Rows<S>{to, m_.nvx});
    }
    return to;
  }

  const CompactImpl& m_;
  BlockScratch<S>& s_;
  DependentJoints<S> dependents_;
};

template <class S>
void runCoupledDerivatives(const CompactImpl& m, BlockScratch<S>& s, const Block<Real<S>>& b, const Results<S>& results) {
  const std::ptrdiff_t n = m.nv;
  CoupledDerivatives<S> coupled(m, s);
  const auto forces = [&] {
    evaluateSubspaceDerivatives(m, s.d, s.q, s.v);
    rneaDerivatives<S>(m, s.w, s.d, s.v, s.a);
    return coupled.ofForces();
  };
  const auto putInverse = [&](int result) {
    results.put(result, coupled.inverse(), n * n);
    results.putFailures(s.w.failed);
  };
  if (b.algorithm == Algorithm::rnea_derivatives) {
    int result = 0;
    for (S* matrix : forces()) results.put(result++, matrix, n * n);
  } else if (b.algorithm == Algorithm::aba_derivatives) {
    const auto [by_q, by_v, inertia] = forces();
    results.put(3, s.result, n);
    putInverse(2);
    int result = 0;
    for (S* matrix : {by_q, by_v}) {
      coupled.toAccelerations(matrix);
      results.put(result++, matrix, n * n);
    }
  } else if (b.algorithm == Algorithm::minverse) {
    putInverse(0);
  } else {
    evaluateSubspaceDerivatives(m, s.d, s.q, s.v);
    std::fill(s.a, s.a + m.nvx, S(0));
    coriolisMatrix<S>(m, s.w, s.d, s.v, s.a);
    results.put(0, coupled.coriolis(), n * n);
  }
}

}  // namespace dyn::kernels
