// SPDX-License-Identifier: BSD-2-Clause
// Blocks of states of models with couplings: the same steps as for one state (algorithm/), on packs. Inputs are in expanded coordinates, results in
// the user's.
#pragma once

#include "kernels/body/dissipation.hpp"
#include "kernels/isa/block.hpp"
#include "kernels/order/register_cached.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/dense_factors.hpp"
#include "kernels/recursion/kinematics.hpp"
#include "kernels/recursion/rnea.hpp"

#include <algorithm>

namespace dyn::kernels {

template <class S>
class CoupledBlock {
 public:
  CoupledBlock(const CachedBodies<S>& bodies, BlockScratch<S>& s, const Block<Real<S>>& b)
      : bodies_(bodies), s_(s), b_(b), m_(bodies.m), dependents_(s.coupled.dependents(m_, s.v, s.a)) {
    loadColumns(b.couplings, static_cast<int>(3 * m_.couplings.size()), s.coupled.couplings);
  }

  /// Writes s.result.
  void rnea() {
    expandedRnea();
    dependents_.keep(1, s_.coupled.tau, s_.result);
  }
  /// Writes s.coupled.M.
  void massMatrix() {
    kernels::massMatrix(bodies_, s_.w, s_.M);
    dependents_.foldInertia(s_.M);
    dependents_.keepSquare(s_.M, s_.coupled.M);
    s_.coupled.clear(m_, s_.M);
  }
  /// Writes the factors of M to s.coupled.M, and bodies whose pivots vanish to w.failed.
  void factors() {
    massMatrix();
    std::fill(std::begin(s_.w.failed), std::end(s_.w.failed), 0);
    factorDense(m_, s_.coupled.M, s_.coupled.diagonal, s_.w.failed);
  }
  /// Writes s.result. The expanded a must hold the dependent joints' accelerations for zero acceleration of their masters.
  void aba() {
    rnea();
    loadColumns(b_.forces, m_.nv, s_.coupled.forces);
    for (int k = 0; k < m_.nv; ++k) s_.result[k] = s_.coupled.forces[k] - s_.result[k];
    factors();
    solveDense(m_, s_.coupled.M, s_.result);
  }
  /// Writes s.J.
  void frameJacobian() {
    forwardKinematics(bodies_, s_.w, static_cast<const S*>(nullptr), static_cast<const S*>(nullptr));
    kernels::frameJacobian(bodies_, s_.w, {b_.frame.body, cast<S>(b_.frame.placement)}, b_.reference, s_.J, 6);
    dependents_.fold(6, s_.J);
    dependents_.keep(6, s_.J, s_.J);
  }
  /// Computes the inputs of runDerivatives(). Derivatives of aba need accelerations in s.result and in s.a, and like those of rnea the forces in
  /// s.coupled.tau. M^-1 needs factors. The Coriolis matrix needs the expanded M.
  void beforeDerivatives() {
    if (b_.algorithm == Algorithm::aba_derivatives) {
      aba();
      dependents_.follow(s_.result, s_.a);
    }
    if (b_.algorithm == Algorithm::rnea_derivatives || b_.algorithm == Algorithm::aba_derivatives) expandedRnea();
    if (b_.algorithm == Algorithm::minverse) factors();
    if (b_.algorithm == Algorithm::coriolis) kernels::massMatrix(bodies_, s_.w, s_.M);
  }

 private:
  void expandedRnea() {
    S* tau = s_.coupled.tau;
    rneaOutward(bodies_, s_.w, s_.v, s_.a);
    rneaInward(bodies_, s_.w, tau);
    addJointForces(m_, s_.v, s_.a, tau);
    dependents_.foldForces(tau);
  }

  const CachedBodies<S>& bodies_;
  BlockScratch<S>& s_;
  const Block<Real<S>>& b_;
  const CompactImpl& m_;
  DependentJoints<S> dependents_;
};

/// Runs all algorithms but kinematics, which need no folding. The joints must have been evaluated before.
template <class S>
[[gnu::noinline]] void runCoupledBlock(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b) {
  const CachedBodies<S> bodies{{m, s.w}};
  CoupledBlock<S> block(bodies, s, b);
  const Results<S> results(b);
  switch (b.algorithm) {
    case Algorithm::frame_jacobian:
      block.frameJacobian();
      return results.put(0, s.J, 6 * static_cast<std::ptrdiff_t>(m.nv));
    case Algorithm::rnea:
    case Algorithm::nle:
    case Algorithm::gravity:
      block.rnea();
      return results.put(0, s.result, m.nv);
    case Algorithm::mass_matrix:
      block.massMatrix();
      return results.put(0, s.coupled.M, static_cast<std::ptrdiff_t>(m.nv) * m.nv);
    case Algorithm::aba:
      block.aba();
      results.putFailures(s.w.failed);
      return results.put(0, s.result, m.nv);
    default:
      block.beforeDerivatives();
      return runDerivatives(m, s, b);
  }
}

}  // namespace dyn::kernels
