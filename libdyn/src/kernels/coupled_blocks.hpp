// Blocks of states of models with couplings: what one state does (algorithm/), with packs. Inputs are expanded; results are the user's.
#pragma once

#include "kernels/block.hpp"
#include "kernels/columns.hpp"
#include "kernels/crba.hpp"
#include "kernels/dense_factors.hpp"
#include "kernels/kept.hpp"
#include "kernels/kinematics.hpp"
#include "kernels/losses.hpp"
#include "kernels/rnea.hpp"

#include <algorithm>

namespace dyn::kernels {

template <class S>
class CoupledBlock {
 public:
  CoupledBlock(const KeepingBodies<S>& bodies, BlockScratch<S>& s, const Block<Real<S>>& b)
      : bodies_(bodies), s_(s), b_(b), m_(bodies.m), followers_(s.coupled.followers(m_, s.v, s.a)) {
    loadColumns(b.couplings, static_cast<int>(3 * m_.couplings.size()), s.coupled.couplings);
  }

  /// Into s.result.
  void rnea() {
    expandedRnea();
    followers_.keep(1, s_.coupled.tau, s_.result);
  }
  /// Into s.coupled.M.
  void massMatrix() {
    kernels::massMatrix(bodies_, s_.w, s_.M);
    followers_.foldInertia(s_.M);
    followers_.keepSquare(s_.M, s_.coupled.M);
    s_.coupled.clear(m_, s_.M);
  }
  /// The same, factored; pivots that vanish in w.failed.
  void factors() {
    massMatrix();
    std::fill(std::begin(s_.w.failed), std::end(s_.w.failed), 0);
    factorDense(m_, s_.coupled.M, s_.coupled.diagonal, s_.w.failed);
  }
  /// Into s.result. a: what followers do by themselves.
  void aba() {
    rnea();
    loadColumns(b_.forces, m_.nv, s_.coupled.forces);
    for (int k = 0; k < m_.nv; ++k) s_.result[k] = s_.coupled.forces[k] - s_.result[k];
    factors();
    solveDense(m_, s_.coupled.M, s_.result);
  }
  /// Into s.J.
  void frameJacobian() {
    forwardKinematics(bodies_, s_.w, static_cast<const S*>(nullptr), static_cast<const S*>(nullptr));
    kernels::frameJacobian(bodies_, s_.w, {b_.frame.body, cast<S>(b_.frame.placement)}, b_.reference, s_.J, 6);
    followers_.fold(6, s_.J);
    followers_.keep(6, s_.J, s_.J);
  }
  /// What runDerivatives() takes from algorithms that are not derivatives: of aba, accelerations in s.result and in s.a; of rnea and aba, forces in
  /// s.coupled.tau; of the inverse, factors; for the Coriolis matrix, M expanded.
  void beforeDerivatives() {
    if (b_.task == Task::aba_derivatives) {
      aba();
      followers_.follow(s_.result, s_.a);
    }
    if (b_.task == Task::rnea_derivatives || b_.task == Task::aba_derivatives) expandedRnea();
    if (b_.task == Task::minverse) factors();
    if (b_.task == Task::coriolis) kernels::massMatrix(bodies_, s_.w, s_.M);
  }

 private:
  void expandedRnea() {
    S* tau = s_.coupled.tau;
    rneaOutward(bodies_, s_.w, s_.v, s_.a);
    rneaInward(bodies_, s_.w, tau);
    addJointForces(m_, s_.v, s_.a, tau);
    followers_.foldForces(tau);
  }

  const KeepingBodies<S>& bodies_;
  BlockScratch<S>& s_;
  const Block<Real<S>>& b_;
  const CompactImpl& m_;
  Followers<S> followers_;
};

/// All tasks but kinematics, which have nothing to fold. Joints asked.
template <class S>
[[gnu::noinline]] void runCoupledBlock(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b) {
  const KeepingBodies<S> bodies{{m, s.w}};
  CoupledBlock<S> block(bodies, s, b);
  const Results<S> results(b);
  switch (b.task) {
    case Task::frame_jacobian:
      block.frameJacobian();
      return results.put(0, s.J, 6 * static_cast<std::ptrdiff_t>(m.nv));
    case Task::rnea:
      block.rnea();
      return results.put(0, s.result, m.nv);
    case Task::mass_matrix:
      block.massMatrix();
      return results.put(0, s.coupled.M, static_cast<std::ptrdiff_t>(m.nv) * m.nv);
    case Task::aba:
      block.aba();
      results.putFailures(s.w.failed);
      return results.put(0, s.result, m.nv);
    default:
      block.beforeDerivatives();
      return runDerivatives(m, s, b);
  }
}

}  // namespace dyn::kernels
