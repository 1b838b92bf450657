// SPDX-License-Identifier: BSD-2-Clause
// The memory of the recursions of derivatives, and the derivatives of motion subspaces that vary with q.
#pragma once

#include "kernels/body/centroidal_state.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/derivative/column_projections.hpp"
#include "kernels/derivative/path_pairs.hpp"
#include "kernels/order/vectored_bodies.hpp"
// Specialisations come before the templates that use them.
#include "kernels/derivative/cholesky.hpp"
#include "kernels/derivative/tree_factors.hpp"
#include "kernels/recursion/aligned.hpp"

namespace dyn::kernels {

/// How the subspaces of one batch of joints change along the joints' own degrees of freedom, in the moving frame's axes. Component c of joint k is
/// at [c * stride + k].
template <class S>
struct SubspaceDerivatives {
  S* columns = nullptr;  ///< dS/dq_m: 6 nv components for each m
  S* bias = nullptr;     ///< derivative of (dS/dt) v w.r.t. q_m at constant v: 6 components for each m
  std::ptrdiff_t stride = 0;

  Motion<S> at(const S* from, int component, int slot) const {
    const S* p = from + component * stride + slot;
    return {{p[0], p[stride], p[2 * stride]}, {p[3 * stride], p[4 * stride], p[5 * stride]}};
  }
  Motion<S> column(int nv, int m, int k, int slot) const { return at(columns, 6 * (nv * m + k), slot); }
  Motion<S> biasRate(int m, int slot) const { return at(bias, 6 * m, slot); }
};

/// The motion around a degree of freedom: its column, and the motions of its body and of the parent.
template <class S>
struct DofMotion {
  Motion<S> column;
  Vec3<S> w_parent, w;
  Motion<S> acceleration;  ///< of the parent's point at the joint's origin
  Vec3<S> slide;           ///< velocity at which the joint moves its origin
};

/// How the velocity and the acceleration of the whole subtree change with one degree of freedom, in addition to the subtree's rigid rotation. In
/// aligned axes, at the joint's origin, in the inertial frame that moves with that origin.
template <class S>
struct DofVariation {
  Motion<S> velocity;      ///< of the velocity w.r.t. q
  Motion<S> acceleration;  ///< w.r.t. q
  Motion<S> rate;          ///< of the acceleration w.r.t. v
};
/// Terms of a joint whose subspace varies, in aligned axes; zero for other joints.
template <class S>
struct SubspaceTerms {
  Motion<S> velocity, acceleration, rate;  ///< E; A + H; sum_l dS_k/dq_l v_l: see rnea_derivatives.hpp
};

/// Mass, first moment, inertia and momentum of a body or of its subtree, about the joint's origin, with velocities relative to that origin's.
template <class S>
struct SubtreeMomentum {
  S mass;
  Vec3<S> h;
  Sym3<S> I;
  Force<S> momentum;

  SubtreeMomentum& operator+=(const SubtreeMomentum& x) {
    mass += x.mass;
    h += x.h;
    I += x.I;
    momentum += x.momentum;
    return *this;
  }
};
/// The same, with K, which gives the Coriolis forces of rotation rates, and with the force that moves the subtree.
template <class S>
struct Subtree {
  SubtreeMomentum<S> m;
  Mat3<S> K;  ///< sum of mass * velocity * position^T
  Force<S> f;

  Subtree& operator+=(const Subtree& x) {
    m += x.m;
    K += x.K;
    f += x.f;
    return *this;
  }
};

/// The Coriolis force, as a linear map of the rotation rate, on a subtree whose joints respond: an articulated 6 x 3 matrix.
template <class S>
struct CoriolisMap {
  Mat3<S> linear, angular;

  CoriolisMap& operator+=(const CoriolisMap& x) {
    linear += x.linear;
    angular += x.angular;
    return *this;
  }
};

/// Derivatives of inverse dynamics by q, v and, unless null, a: n x n each. Entries of two degrees of freedom that are on no common root path must be
/// zero before and are not written.
struct PathDerivatives {
  double *by_q, *by_v, *by_a;
};

/// The first number of each array that a recursion over lane groups writes.
struct LaneGroupArrays {
  const double *offsets = nullptr, *offset_rates = nullptr, *turnings = nullptr, *accelerations = nullptr;  ///< by lane group
  const double *dofs = nullptr, *variations = nullptr;                                                      ///< by its degrees of freedom
};

template <class S>
struct DerivativeWorkspace {
  SubspaceDerivatives<S>* subspaces = nullptr;  ///< by batch; empty ones but for dense shapes
  Dual<double>* dual = nullptr;                 ///< q, v, pose, subspace and bias of the largest batch
  // Recursions over bodies write these. Those of single states have whole vectors in registers and write to `vectored` instead.
  DofVariation<S>* dof = nullptr;
  Vec3<S>* shift_rate = nullptr;       ///< velocity of each joint's origin relative to the parent's
  Subtree<S>* subtree = nullptr;       ///< by body, about its joint's origin; in aba only m, and that of the body alone
  DofForces<S>* dof_force = nullptr;   ///< at the joint's own origin, until they go to the root
  CoriolisMap<S>* coriolis = nullptr;  ///< articulated, the sum that the children hand over [aba]
  Motion<S>* place = nullptr;          ///< [centroidal] from each joint's origin to the centre of mass, and its rate, aligned axes
  Workspace<Vectored> bodies;          ///< for single states
  DerivativeWorkspace<Vectored>* vectored = nullptr;
  char* lane_groups = nullptr;   ///< for single states: LaneGroupDerivatives, where recursions are over lane groups
  LaneGroupArrays group_arrays;  ///< their results for other algorithms

  // Results of sweeps to the root: matrices, or pairs for states in packs; the upper entries of aba's pairs are in `projections`.
  PathMatrix<S> by_q, by_v, by_a;
  PathPairs<S> pairs;
  ColumnProjections<S> projections;
  TreeFactors<S> factors;
  PathFactors<S> cholesky;
  S* damping = nullptr;  ///< by degree of freedom, with zeros after the last for whole packs; null where there is none
};

/// Lays out the arrays that recursions over bodies write.
template <class S>
void layOutRecursions(DerivativeWorkspace<S>& w, std::size_t bodies, std::size_t dofs, Arena& arena) {
  arena.take(w.dof, dofs);
  arena.take(w.shift_rate, bodies);
  arena.take(w.subtree, bodies);
  arena.take(w.dof_force, dofs);
  arena.take(w.coriolis, bodies);
  arena.take(w.place, bodies);
}
template <class S>
void layOut(DerivativeWorkspace<S>& w, const CompactImpl& m, Arena& arena) {
  arena.take(w.subspaces, m.batches.size());
  std::size_t numbers = 0;
  SubspaceDerivatives<S> counted;
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    SubspaceDerivatives<S>& out = w.subspaces ? w.subspaces[b] : counted;
    out = {};
    if (batch.shape != Shape::dense) continue;
    const auto count = static_cast<std::size_t>(batch.count), nv = static_cast<std::size_t>(batch.nv), nq = static_cast<std::size_t>(batch.nq);
    out.stride = batch.count;
    arena.take(out.columns, 6 * nv * nv * count);
    arena.take(out.bias, 6 * nv * count);
    numbers = std::max(numbers, (nq + nv + 12 + 6 * nv + 6) * count * static_cast<std::size_t>(lanes_of<S>));
  }
  arena.take(w.dual, numbers);
  const auto nv = static_cast<std::size_t>(m.nvx);
  const auto bodies = static_cast<std::size_t>(m.bodies());
  if constexpr (pack_width<S> > 1) {
    layOutDynamics(w.bodies, bodies, nv, arena);
    arena.take(w.bodies.product, bodies);
    arena.take(w.vectored, 1);
    DerivativeWorkspace<Vectored> without;
    DerivativeWorkspace<Vectored>& x = w.vectored ? *w.vectored : without;
    x = {};
    layOutRecursions(x, bodies, nv, arena);
    // A number of S is a double in memory.
    x.subspaces = reinterpret_cast<SubspaceDerivatives<Vectored>*>(w.subspaces);
  } else {
    layOutRecursions(w, bodies, nv, arena);
  }
  const int rows = (m.nvx + pack_width<S> - 1) / pack_width<S> * pack_width<S>;  // for whole packs and tiles
  if (!m.damping.empty()) arena.take(w.damping, static_cast<std::size_t>(rows));
  if (w.damping) {
    std::fill_n(w.damping, rows, S(0));
    for (std::size_t k = 0; k < m.damping.size(); ++k) w.damping[k] = S(static_cast<Real<S>>(m.damping[k]));
  }
  if constexpr (in_pairs<S>) {
    w.pairs.layOut(m, w.dof_force, arena);
    w.projections.layOut(m, arena);
  } else {
    for (PathMatrix<S>* matrix : {&w.by_q, &w.by_v, &w.by_a}) {
      arena.take(matrix->below, rows, m.nvx);
      if (matrix != &w.by_a) arena.take(matrix->right, rows, m.nvx);
    }
    w.by_a.right = w.by_a.below;  // symmetric
  }
  layOut(w.factors, m.nvx, arena);
  if (w.vectored) w.vectored->factors.inverse = reinterpret_cast<Vectored*>(w.factors.inverse);
  if constexpr (lanes_of<S> == 1) layOut(w.cholesky, m, arena);
}

/// Fills w.subspaces by one differentiated call for each batch and each degree of freedom of its type. q and v are in expanded coordinates.
template <class S>
void evaluateSubspaceDerivatives(const CompactImpl& m, DerivativeWorkspace<S>& w, const S* q, const S* v) {
  using T = Real<S>;
  constexpr int lanes = lanes_of<S>;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    if (batch.shape != Shape::dense) continue;
    const SubspaceDerivatives<S>& out = w.subspaces[b];
    const std::ptrdiff_t items = static_cast<std::ptrdiff_t>(batch.count) * lanes;
    JointBatch<Dual<double>> call;
    call.count = batch.count;
    call.lanes = lanes;
    call.constants = batch.constants.data();
    call.constant_count = batch.constant_count;
    call.constants_stride = batch.count;
    call.stride = call.q_stride = call.v_stride = items;
    Dual<double>*dual_q = w.dual, *dual_v = dual_q + batch.nq * items;
    call.q = dual_q;
    call.v = dual_v;
    call.pose = dual_v + batch.nv * items;
    call.subspace = call.pose + 12 * items;
    call.bias = call.subspace + 6 * batch.nv * items;
    const auto spread = [&](const S* from, int BodyIndex::*first, int size, Dual<double>* to) {
      for (int k = 0; k < batch.count; ++k) {
        const S* joint = from + m.index[at(batch.bodies[at(k)])].*first;
        for (int c = 0; c < size; ++c)
          for (int l = 0; l < lanes; ++l) to[c * items + k * lanes + l] = static_cast<double>(reinterpret_cast<const T*>(joint + c)[l]);
      }
    };
    spread(q, &BodyIndex::idx_q, batch.nq, dual_q);
    spread(v, &BodyIndex::idx_v, batch.nv, dual_v);
    for (int along = 0; along < batch.nv; ++along) {
      // Before the call, the results' memory holds the unit velocity and the change of q.
      for (int c = 0; c < batch.nv; ++c) std::fill_n(call.subspace + c * items, items, Dual<double>(c == along ? 1.0 : 0.0));
      coordinateRates(batch, 0, batch.count, lanes, dual_q, call.subspace, call.pose);
      for (std::ptrdiff_t i = 0; i < batch.nq * items; ++i) dual_q[i] = {dual_q[i].v, call.pose[i].v};
      batch.type->kinematics(call);
      const auto keep = [&](const Dual<double>* from, int size, S* to) {
        T* numbers = reinterpret_cast<T*>(to);
        for (std::ptrdiff_t i = 0; i < size * items; ++i) numbers[i] = static_cast<T>(from[i].d);
      };
      keep(call.subspace, 6 * batch.nv, out.columns + 6 * batch.nv * along * batch.count);
      keep(call.bias, 6, out.bias + 6 * along * batch.count);
    }
  }
}

}  // namespace dyn::kernels
