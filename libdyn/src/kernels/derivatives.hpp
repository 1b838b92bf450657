// Memory of the derivatives' recursions, and what joints whose subspace varies add to them.
#pragma once

#include "kernels/column_shares.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/path_pairs.hpp"
#include "kernels/vectored_bodies.hpp"
// Specialisations come before what is made of them.
#include "kernels/aligned.hpp"
#include "kernels/cholesky.hpp"
#include "kernels/tree_factors.hpp"

namespace dyn::kernels {

/// How a joint's subspace changes along one of its own degrees of freedom, in the moving frame's axes, of one batch: component c of joint
/// k at [c * stride + k].
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

/// A degree of freedom in motion: its column, and what its body and the parent do.
template <class S>
struct DofMotion {
  Motion<S> column;
  Vec3<S> w_parent, w;
  Motion<S> acceleration;  ///< of the parent where the joint's origin is
  Vec3<S> slide;           ///< velocity at which the joint carries its origin
};

/// Of one degree of freedom, aligned axes, at the joint's origin, in the inertial frame that moves as that origin does: how the velocity
/// and the acceleration of the whole subtree change with it, beside what turning the subtree rigidly changes.
template <class S>
struct DofVariation {
  Motion<S> velocity;      ///< of the velocity w.r.t. q
  Motion<S> acceleration;  ///< w.r.t. q
  Motion<S> rate;          ///< of the acceleration w.r.t. v
};
/// What a joint of varying subspace adds, in aligned axes; zero for the others.
template <class S>
struct SubspaceTerms {
  Motion<S> velocity, acceleration, rate;  ///< E; A + H; sum_n dS_m/dq_n v_n
};

/// Of a body or its subtree, about the joint's origin, velocities relative to that origin's.
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
/// With what turning rates and accelerations bring to it.
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

/// Force that each turning rate brings to a subtree whose joints are free to move.
template <class S>
struct CoriolisMap {
  Mat3<S> linear, angular;

  CoriolisMap& operator+=(const CoriolisMap& x) {
    linear += x.linear;
    angular += x.angular;
    return *this;
  }
};

/// Derivatives of inverse dynamics by q, v and, unless null, a: n x n each, zeros where no path leads. These stay as they are.
struct PathDerivatives {
  double *by_q, *by_v, *by_a;
};

/// Columns of 6 numbers, linear part first, in world axes about the centre of mass; null: not wanted.
template <class S>
struct CentroidalMaps {
  S *Ag = nullptr, *dAg = nullptr;                               ///< momentum by v, and its time derivative
  S *dh_dq = nullptr, *dhdot_dq = nullptr, *dhdot_dv = nullptr;  ///< of momentum, and of its rate

  bool rates() const { return dAg || dh_dq || dhdot_dq || dhdot_dv; }  ///< more than Ag and momentum
};
template <class S>
struct CentroidalState {
  Force<S> momentum, rate;  ///< world axes, about the centre of mass
  Sym3<S> inertia;          ///< of the whole, locked, about the centre of mass, world axes
  S mass;
};

/// Numbers of strips' arrays: of each struct in them the first.
struct StripArrays {
  const double *levers = nullptr, *lever_rates = nullptr, *turnings = nullptr, *accelerations = nullptr;  ///< by strip
  const double *dofs = nullptr, *variations = nullptr;                                                    ///< by its degrees of freedom
};

template <class S>
struct DerivativeWorkspace {
  SubspaceDerivatives<S>* subspaces = nullptr;  ///< by batch; empty ones but for dense shapes
  Dual<double>* dual = nullptr;                 ///< of the largest batch: q, v, pose, subspace, bias
  // What recursions over bodies write. Those of single states have vectors in registers, and what they write is in `vectored`.
  DofVariation<S>* dof = nullptr;
  Vec3<S>* shift_rate = nullptr;       ///< velocity of each joint's origin relative to the parent's
  Subtree<S>* subtree = nullptr;       ///< by body, about its joint's origin; in aba of the body alone, and of that m
  DofForces<S>* dof_force = nullptr;   ///< at the joint's own origin, until they climb
  CoriolisMap<S>* coriolis = nullptr;  ///< articulated, of what the children hand over [aba]
  Motion<S>* place = nullptr;          ///< [centroidal] from each joint's origin to the centre of mass, and its rate, aligned axes
  Workspace<Vectored> bodies;          ///< of single states
  DerivativeWorkspace<Vectored>* vectored = nullptr;
  char* strips = nullptr;    ///< of single states, StripDerivatives where recursions are over strips
  StripArrays strip_arrays;  ///< what these leave to others

  // What sweeps to the root find: matrices, or, of states in packs, pairs, and in aba right of the diagonals columns' shares.
  PathMatrix<S> by_q, by_v, by_a;
  PathPairs<S> pairs;
  ColumnShares<S> shares;
  TreeFactors<S> factors;
  PathFactors<S> cholesky;
  S* damping = nullptr;  ///< by degree of freedom, with zeros after the last for whole packs; null where there is none
};

/// What recursions over bodies write.
template <class S>
void carveRecursions(DerivativeWorkspace<S>& w, std::size_t bodies, std::size_t dofs, Arena& arena) {
  arena.take(w.dof, dofs);
  arena.take(w.shift_rate, bodies);
  arena.take(w.subtree, bodies);
  arena.take(w.dof_force, dofs);
  arena.take(w.coriolis, bodies);
  arena.take(w.place, bodies);
}
template <class S>
void carve(DerivativeWorkspace<S>& w, const CompactImpl& m, Arena& arena) {
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
  if constexpr (abreast<S> > 1) {
    carveDynamics(w.bodies, bodies, nv, arena);
    arena.take(w.bodies.product, bodies);
    arena.take(w.vectored, 1);
    DerivativeWorkspace<Vectored> without;
    DerivativeWorkspace<Vectored>& x = w.vectored ? *w.vectored : without;
    x = {};
    carveRecursions(x, bodies, nv, arena);
    // A number of theirs is a double in memory.
    x.subspaces = reinterpret_cast<SubspaceDerivatives<Vectored>*>(w.subspaces);
  } else {
    carveRecursions(w, bodies, nv, arena);
  }
  const int rows = (m.nvx + abreast<S> - 1) / abreast<S> * abreast<S>;  // for whole packs and tiles
  if (!m.damping.empty()) arena.take(w.damping, static_cast<std::size_t>(rows));
  if (w.damping) {
    std::fill_n(w.damping, rows, S(0));
    for (std::size_t k = 0; k < m.damping.size(); ++k) w.damping[k] = S(static_cast<Real<S>>(m.damping[k]));
  }
  if constexpr (in_pairs<S>) {
    w.pairs.carve(m, w.dof_force, arena);
    w.shares.carve(m, arena);
  } else {
    for (PathMatrix<S>* matrix : {&w.by_q, &w.by_v, &w.by_a}) {
      arena.take(matrix->below, rows, m.nvx);
      if (matrix != &w.by_a) arena.take(matrix->right, rows, m.nvx);
    }
    w.by_a.right = w.by_a.below;  // symmetric
  }
  carve(w.factors, m.nvx, arena);
  if (w.vectored) w.vectored->factors.inverse = reinterpret_cast<Vectored*>(w.factors.inverse);
  if constexpr (lanes_of<S> == 1) carve(w.cholesky, m, arena);
}

/// One differentiated call a batch and degree of freedom of its type. q and v in expanded coordinates.
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
      // How q changes is written where the results come later.
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
