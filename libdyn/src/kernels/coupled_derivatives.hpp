// Derivatives of blocks of states of models with couplings, after what CoupledBlock has left: expanded matrices folded to the user's.
#pragma once

#include "kernels/block.hpp"
#include "kernels/coriolis.hpp"
#include "kernels/dense_factors.hpp"
#include "kernels/rnea_derivatives.hpp"

#include <algorithm>
#include <array>

namespace dyn::kernels {

template <class S>
class CoupledDerivatives {
 public:
  CoupledDerivatives(const CompactImpl& m, BlockScratch<S>& s) : m_(m), s_(s), followers_(s.coupled.followers(m, s.v, s.a)) {}

  /// After derivatives of rnea: these by q, v and a.
  std::array<S*, 3> ofForces() {
    const std::array<S*, 3> x{expanded(s_.d.by_q, Pairs::q_below, 0), expanded(s_.d.by_v, Pairs::v_below, 1), expanded(s_.d.by_a, Pairs::by_a, 2)};
    followers_.foldForceDerivatives(s_.coupled.tau, x[0], x[1], x[2]);
    for (S* matrix : x) followers_.keepSquare(matrix, matrix);
    return x;
  }
  /// -M^-1 x, in place.
  void toAccelerations(S* x) const {
    const std::ptrdiff_t n = m_.nv;
    for (std::ptrdiff_t k = 0; k < n; ++k) solveDense(m_, s_.coupled.M, x + n * k);
    for (std::ptrdiff_t i = 0; i < n * n; ++i) x[i] = -x[i];
  }
  S* inverse() {
    invertDense(m_, s_.coupled.M, s_.matrix);
    return s_.matrix;
  }
  /// After what leaves it expanded in s.d.by_v.
  S* coriolis() {
    S* C = expanded(s_.d.by_v, Pairs::v_below, 1);
    followers_.foldCoriolis(C, s_.M);
    s_.coupled.clear(m_, s_.M);
    followers_.keepSquare(C, C);
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
  Followers<S> followers_;
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
  if (b.task == Task::rnea_derivatives) {
    int result = 0;
    for (S* matrix : forces()) results.put(result++, matrix, n * n);
  } else if (b.task == Task::aba_derivatives) {
    const auto [by_q, by_v, inertia] = forces();
    results.put(3, s.result, n);
    putInverse(2);
    int result = 0;
    for (S* matrix : {by_q, by_v}) {
      coupled.toAccelerations(matrix);
      results.put(result++, matrix, n * n);
    }
  } else if (b.task == Task::minverse) {
    putInverse(0);
  } else {
    evaluateSubspaceDerivatives(m, s.d, s.q, s.v);
    std::fill(s.a, s.a + m.nvx, S(0));
    coriolisMatrix<S>(m, s.w, s.d, s.v, s.a);
    results.put(0, coupled.coriolis(), n * n);
  }
}

}  // namespace dyn::kernels
