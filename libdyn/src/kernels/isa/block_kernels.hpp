// SPDX-License-Identifier: BSD-2-Clause
// Batches: loads states from the caller's columns into packs, runs the recursions on packs, and stores the results in columns.
#pragma once

#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/body/scratch.hpp"
#include "kernels/derivative/tree_factors.hpp"
#include "kernels/isa/block.hpp"
#include "kernels/isa/coupled_blocks.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/order/register_cached.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/recursion/body_sums.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/kinematics.hpp"
#include "kernels/recursion/local_aba.hpp"
#include "kernels/recursion/rnea.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Computes poses in the world, and where they are wanted velocities and accelerations; for the centre of mass and energies their sums, too.
template <class S>
void runKinematics(const CompactImpl& m, const CachedBodies<S>& bodies, const BlockScratch<S>& s, Block<Real<S>>& b) {
  Workspace<S> out = s.w;
  const bool keeps = b.poses != nullptr;
  if (keeps) out.oM = static_cast<SE3<S>*>(b.poses);
  out.oM[0] = {};
  if (b.velocities) out.v = static_cast<Motion<S>*>(b.velocities);
  if (b.accelerations) out.a = static_cast<Motion<S>*>(b.accelerations);
  if (keeps) out.sliding = nullptr;
  const bool moves = keeps ? b.velocities != nullptr : b.v.first != nullptr;
  const bool accelerates = keeps ? b.accelerations != nullptr : b.results[2] != nullptr;
  kernels::forwardKinematics<Poses::in_world>(bodies, out, moves ? s.v : nullptr, accelerates ? s.a : nullptr);
  b.not_finite = !allFinite(reinterpret_cast<const S*>(out.oM), 12 * static_cast<std::ptrdiff_t>(m.bodies()));
  if (keeps) return;
  const Results<S> results(b);
  if (b.algorithm == Algorithm::energies) {
    const S energies[] = {moves ? kineticEnergy(bodies, out, s.v) : S(0), potentialEnergy(bodies, out)};
    for (int k = 0; k < 2; ++k) results.put(k, energies + k, 1);
    return;
  }
  const MassMotion<S> sum = centerOfMass(bodies, out, moves, accelerates);
  const Vec3<S>* const vectors[] = {&sum.position, &sum.velocity, &sum.acceleration};
  for (int k = 0; k < 3; ++k) results.put(k, &vectors[k]->x, 3);
}

template <class S>
void loadStates(const CompactImpl& m, BlockScratch<S>& s, const Block<Real<S>>& b) {
  s.w.inertias = static_cast<const InertiaConstants<S>*>(b.inertias);
  loadColumns(b.q, m.nqx, s.q);
  loadColumns(b.v, m.nvx, s.v);
  loadColumns(b.a, m.nvx, s.a);
}

/// The articulated-body recursion without its last pass. The joints must have been evaluated before.
template <class S>
void articulate(const CompactImpl& m, const CachedBodies<S>& bodies, BlockScratch<S>& s, Block<Real<S>>& b) {
  addDissipation(m, -1.0, s.v, s.a);
  localAbaOutward(bodies, s.w, s.v);
  localAbaInward(bodies, s.w, s.a);
  for (int l = 0; l < b.q.states; ++l) b.failed[l] = s.w.failed[l];
}

template <class S>
void articulateStates(const CompactImpl& m, BlockScratch<S>& s, Block<Real<S>>& b) {
  loadStates(m, s, b);
  evaluateJoints(m, s.w, s.q, s.v);
  const CachedBodies<S> bodies{{m, s.w}};
  articulate(m, bodies, s, b);
  columnsOutward<Orthonormalisation::from_columns>(bodies, s.w);
}

template <class S>
void accelerateStates(const CompactImpl& m, BlockScratch<S>& s, const Vec3<double>& gravity, Block<Real<S>>& b) {
  localAbaSolve(CachedBodies<S>{{m, s.w}}, s.w, cast<S>(gravity), s.result);
  b.not_finite = !storeColumns(s.result, m.nvx, b.q.states, b.results[0], m.nvx);
}

template <class S, class T = Real<S>>
void runBlock(const CompactImpl& m, char* scratch, Block<T>& b) {
  BlockScratch<S>& s = *reinterpret_cast<BlockScratch<S>*>(scratch);
  Workspace<S>& w = s.w;
  const CachedBodies<S> bodies{{m, w}};
  loadStates(m, s, b);
  const bool poses_only = b.algorithm == Algorithm::mass_matrix || b.algorithm == Algorithm::joint_jacobians ||
                          b.algorithm == Algorithm::frame_jacobian || b.algorithm == Algorithm::minverse;
  evaluateJoints(m, w, s.q, poses_only ? nullptr : s.v);
  const bool kinematic = b.poses != nullptr || b.algorithm == Algorithm::center_of_mass || b.algorithm == Algorithm::energies;
  if (!m.couplings.empty() && !kinematic) return runCoupledBlock(m, s, b);
  switch (b.algorithm) {
    case Algorithm::placements:
    case Algorithm::velocities:
    case Algorithm::accelerations:
    case Algorithm::center_of_mass:
    case Algorithm::energies:
      return runKinematics(m, bodies, s, b);
    case Algorithm::joint_jacobians:
    case Algorithm::frame_jacobian: {
      const std::ptrdiff_t n = 6 * static_cast<std::ptrdiff_t>(m.nvx);
      if (b.algorithm == Algorithm::joint_jacobians) {
        kernels::jointJacobians(bodies, w, s.J);
      } else {
        kernels::forwardKinematics(bodies, w, static_cast<const S*>(nullptr), static_cast<const S*>(nullptr));
        frameJacobian(bodies, w, {b.frame.body, cast<S>(b.frame.placement)}, b.reference, s.J, 6);
      }
      b.not_finite = !storeColumns(s.J, n, b.q.states, b.results[0], n);
      return;
    }
    case Algorithm::rnea:
    case Algorithm::nle:
    case Algorithm::gravity:
      rneaOutward(bodies, w, s.v, s.a);
      rneaInward(bodies, w, s.result);
      addJointForces(m, s.v, s.a, s.result);
      break;
    case Algorithm::mass_matrix: {
      kernels::massMatrix(bodies, w, s.M);
      const std::ptrdiff_t numbers = static_cast<std::ptrdiff_t>(m.nvx) * m.nvx;
      const Results<S> results(b);
      return s.squares.mass.empty() ? results.put(0, s.M, numbers) : results.putSquares(0, s.squares.mass, s.M, numbers);
    }
    case Algorithm::aba:
      articulate(m, bodies, s, b);
      return accelerateStates(m, s, m.gravity, b);
    case Algorithm::rnea_derivatives:
    case Algorithm::aba_derivatives:
    case Algorithm::minverse:
    case Algorithm::center_of_mass_jacobian:
    case Algorithm::coriolis:
    case Algorithm::centroidal_map:
    case Algorithm::centroidal_rate:
    case Algorithm::centroidal_derivatives:
      return runDerivatives(m, s, b);
    case Algorithm::static_torque:
      return;  // not batched
  }
  b.not_finite = !storeColumns(s.result, m.nvx, b.q.states, b.results[0], m.nvx);
}

template <class S>
BlockKernels<Real<S>> blockKernels() {
  using T = Real<S>;
  BlockKernels<T> k;
  k.lanes = lanes_of<S>;
  k.bytes = [](const CompactImpl& m, Room room) { return scratchBytes<BlockScratch<S>>(m, room); };
  k.prepare = [](const CompactImpl& m, Room room, char* scratch) {
    BlockScratch<S>& s = makeScratch<BlockScratch<S>>(scratch, m, room);
    atRest(s.w);
    if (room.mass_matrix) std::fill(s.M, s.M + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, S(0));
    if (room.mass_matrix) s.squares.prepare(m, room.derivatives, s.d.pairs);
    if (room.derivatives) s.product.prepare(m, s.d.factors);
  };
  k.run = [](const CompactImpl& m, char* scratch, Block<T>& block) { runBlock<S>(m, scratch, block); };
  k.solve = [](const CompactImpl& m, char* scratch, const void* factors, Block<T>& block) {
    const auto& s = *reinterpret_cast<BlockScratch<S>*>(scratch);
    loadColumns(block.a, m.nvx, s.a);
    solveWithKept(m, static_cast<const S*>(factors), s.a);
    block.not_finite = !storeColumns(s.a, m.nvx, block.a.states, block.results[0], m.nvx);
  };
  return k;
}

}  // namespace dyn::kernels
