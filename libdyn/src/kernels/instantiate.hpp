// The kernels of one table: recursions for scalars S, and the way in and out of packs.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/aba_derivatives.hpp"
#include "kernels/centroidal.hpp"
#include "kernels/columns.hpp"
#include "kernels/coriolis.hpp"
#include "kernels/crba.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/kinematics.hpp"
#include "kernels/losses.hpp"
#include "kernels/minverse.hpp"
#include "kernels/rnea.hpp"
#include "kernels/rnea_derivatives.hpp"
#include "kernels/table.hpp"

#include <algorithm>

namespace dyn::kernels {

/// What a single state's degrees of freedom, or columns, are worked on in, side by side: Wide where subtrees are, most of them short;
/// Panel where all of them are.
template <class Wide, class Panel = Wide>
SingleKernels singleKernels() {
  using W = Workspace<double>;
  SingleKernels k;
  k.evaluate = [](const CompactImpl& m, W& w, const double* q, const double* v) { evaluateJoints(m, w, q, v); };
  k.forwardKinematics = [](const CompactImpl& m, W& w, const double* v, const double* a) {
    kernels::forwardKinematics(Bodies<double>{m, w}, w, v, a);
  };
  k.jointJacobians = [](const CompactImpl& m, W& w, double* J) { kernels::jointJacobians(Bodies<double>{m, w}, w, J); };
  k.rnea = [](const CompactImpl& m, W& w, const double* v, const double* a, const Force<double>* fext, double* tau) {
    const Bodies<double> bodies{m, w};
    rneaOutward(bodies, w, v, a, fext);
    rneaInward(bodies, w, tau);
    addArmature(m, a, tau);
    addLosses(m, 1.0, v, tau);
  };
  k.massMatrix = [](const CompactImpl& m, W& w, double* M) { kernels::massMatrix(Bodies<double>{m, w}, w, M); };
  k.aba = [](const CompactImpl& m, W& w, const double* v, const double* tau, const Force<double>* fext, double* ddq) {
    const Bodies<double> bodies{m, w};
    abaOutward(bodies, w, v, fext);
    abaInward(bodies, w, tau);
    abaSolve(bodies, w, ddq);
  };
  using D = DerivativeWorkspace<double>;
  k.evaluateSubspaces = [](const CompactImpl& m, D& d, const double* q, const double* v) { evaluateSubspaceDerivatives(m, d, q, v); };
  k.rneaDerivatives = [](const CompactImpl& m, W& w, D& d, const double* v, const double* a, const Force<double>* fext) {
    const Bodies<double> bodies{m, w};
    derivativesOutward(bodies, w, d, bodies.gravity(), v, a, fext);
    derivativesInward(bodies, w, d);
    derivativesSweep<Wide>(bodies, w, d);
  };
  k.abaDerivatives = [](const CompactImpl& m, W& w, D& d, const double* v, const double* a, const Force<double>* fext, double* by_q, double* by_v,
                        double* inverse) {
    const Bodies<double> bodies{m, w};
    derivativesOutward(bodies, w, d, bodies.gravity(), v, a, fext);
    abaDerivativesInward(bodies, w, d);
    pathSweep<Wide>(bodies, w, d);
    ownColumns(bodies, w, d);
    abaDerivative<Wide, Panel>(m, d, d.by_q, Rows<double>{by_q, m.nvx});
    abaDerivative<Wide, Panel>(m, d, d.by_v, Rows<double>{by_v, m.nvx});
    TreeFactors<double> factors = d.factors;
    factors.L = d.by_a.below;
    kernels::inverseOfMassMatrix<Wide, Panel>(m, factors, d.scratch, Rows<double>{inverse, m.nvx});
    return w.failed[0];
  };
  k.centroidal = [](const CompactImpl& m, W& w, D& d, const double* v, const double* a, const CentroidalMaps<double>& out) {
    const Bodies<double> bodies{m, w};
    if (out.rates) {
      derivativesOutward(bodies, w, d, Vec3<double>{}, v, a, static_cast<const Force<double>*>(nullptr));
      derivativesInward(bodies, w, d);
    } else {
      momenta(bodies, w, d, v);
    }
    return kernels::centroidal(bodies, w, d, out);
  };
  k.coriolis = [](const CompactImpl& m, W& w, D& d, const double* v) {
    const Bodies<double> bodies{m, w};
    std::fill(d.scratch.first, d.scratch.first + m.nvx, 0.0);
    derivativesOutward(bodies, w, d, Vec3<double>{}, v, static_cast<const double*>(d.scratch.first), static_cast<const Force<double>*>(nullptr));
    derivativesInward(bodies, w, d);
    coriolisSweep<Wide>(bodies, w, d);
  };
  k.factorTimes = [](const CompactImpl& m, D& d, FactorProduct product, double* x) { kernels::factorTimes<Wide>(m, d.factors, product, x); };
  k.assemble = [](const CompactImpl& m, const PathMatrix<double>& from, double* out) { from.assemble<Wide>(m.dof_end, Rows<double>{out, m.nvx}); };
  k.choleskyDecompose = [](const CompactImpl& m, D& d, const double* M) {
    int failed = 0;
    kernels::choleskyDecompose<Wide>(m, M, d.scratch, d.factors, &failed);
    return failed;
  };
  k.treeFactors = [](const CompactImpl& m, W& w, D& d) {
    const Bodies<double> bodies{m, w};
    inertiasOutward(bodies, w);
    articulatedFactors(bodies, w, d);
    factorsSweep<Wide>(bodies, w, d);
    return w.failed[0];
  };
  k.inverseOfMassMatrix = [](const CompactImpl& m, D& d, double* out) {
    kernels::inverseOfMassMatrix<Wide, Panel>(m, d.factors, d.scratch, Rows<double>{out, m.nvx});
  };
  return k;
}

/// Scratch of one thread for blocks of states.
template <class S>
struct BlockScratch {
  Workspace<S> w;
  S *q, *v, *a, *result, *M, *J;
  DerivativeWorkspace<S> d;
  S *matrix, *inverse;  ///< nvx * nvx
  S* maps[5];           ///< 6 nvx each

  static std::size_t carve(BlockScratch& s, const CompactImpl& m, Room room, char* base) {
    Arena arena(base);
    dyn::carve(s.w, m, arena);
    const auto nq = static_cast<std::size_t>(m.nqx), nv = static_cast<std::size_t>(m.nvx);
    arena.take(s.q, nq);
    arena.take(s.v, nv);
    arena.take(s.a, nv);
    arena.take(s.result, nv);
    arena.take(s.M, room.mass_matrix ? nv * nv : 0);
    arena.take(s.J, room.jacobian ? 6 * nv : 0);
    if (room.derivatives) {
      dyn::kernels::carve(s.d, m, arena);
      arena.take(s.matrix, nv * nv);
      arena.take(s.inverse, m.damping.empty() ? 0 : nv * nv);
      for (S*& map : s.maps) arena.take(map, 6 * nv);
    }
    return arena.used();
  }
};

/// The tasks of derivatives, joints asked.
template <class S, class T = Real<S>>
void runDerivatives(const CompactImpl& m, BlockScratch<S>& s, Block<T>& b) {
  Workspace<S>& w = s.w;
  DerivativeWorkspace<S>& d = s.d;
  const Bodies<S> bodies{m, w};
  const std::ptrdiff_t n = m.nvx;
  const auto none = static_cast<const Force<S>*>(nullptr);
  b.not_finite = false;
  const auto put = [&](int result, const S* numbers, std::ptrdiff_t count) {
    if (b.results[result] == nullptr) return;
    storeColumns(numbers, count, b.q.states, b.results[result]);
    b.not_finite = b.not_finite || !allFinite(numbers, count);
  };
  const Rows<S> matrix{s.matrix, n};
  const auto whole = [&](const PathMatrix<S>& from) {
    if constexpr (PathMatrix<S>::in_place) {
      return from.below.first;
    } else {
      std::fill(s.matrix, s.matrix + n * n, S(0));
      from.template assemble<S>(m.dof_end, matrix);
      return s.matrix;
    }
  };
  const auto inverse = [&](int result, const Rows<S>& L) {
    TreeFactors<S> factors = d.factors;
    factors.L = L;
    inverseOfMassMatrix<S, S>(m, factors, d.scratch, matrix);
    put(result, s.matrix, n * n);
    for (int l = 0; l < b.q.states; ++l) b.failed[l] = w.failed[l];
  };
  switch (b.task) {
    case Task::rnea_derivatives:
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      derivativesOutward(bodies, w, d, bodies.gravity(), s.v, s.a, none);
      derivativesInward(bodies, w, d);
      derivativesSweep<S>(bodies, w, d);
      put(0, whole(d.by_q), n * n);
      put(1, whole(d.by_v), n * n);
      put(2, whole(d.by_a), n * n);
      return;
    case Task::aba_derivatives: {
      addLosses(m, -1.0, s.v, s.a);
      abaOutward(bodies, w, s.v, none);
      abaInward(bodies, w, s.a);
      abaSolve(bodies, w, s.result);
      put(3, s.result, n);
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      derivativesOutward(bodies, w, d, bodies.gravity(), s.v, s.result, none);
      abaDerivativesInward(bodies, w, d);
      pathSweep<S>(bodies, w, d);
      ownColumns(bodies, w, d);
      const auto placeOf = [&](const PathMatrix<S>& by) { return by.in_place ? by.below : matrix; };
      abaDerivative<S, S>(m, d, d.by_q, placeOf(d.by_q));
      put(0, placeOf(d.by_q).first, n * n);
      inverse(2, d.by_a.below);
      if (!m.damping.empty()) std::copy(s.matrix, s.matrix + n * n, s.inverse);
      abaDerivative<S, S>(m, d, d.by_v, placeOf(d.by_v));
      S* by_v = placeOf(d.by_v).first;
      for (std::size_t k = 0; k < m.damping.size(); ++k) {
        const std::ptrdiff_t column = n * static_cast<std::ptrdiff_t>(k);
        for (std::ptrdiff_t i = column; i < column + n; ++i) by_v[i] -= S(static_cast<T>(m.damping[k])) * s.inverse[i];
      }
      put(1, by_v, n * n);
      // What is not on a path was zero, and must be.
      for (const PathMatrix<S>& full : {d.by_q, d.by_v})
        if (full.in_place) std::fill(full.below.first, full.below.first + n * n, S(0));
      return;
    }
    case Task::minverse:
      inertiasOutward(bodies, w);
      articulatedFactors(bodies, w, d);
      factorsSweep<S>(bodies, w, d);
      return inverse(0, d.factors.L);
    case Task::coriolis:
      evaluateSubspaceDerivatives(m, d, s.q, s.v);
      std::fill(s.a, s.a + n, S(0));
      derivativesOutward(bodies, w, d, Vec3<S>{}, s.v, s.a, none);
      derivativesInward(bodies, w, d);
      coriolisSweep<S>(bodies, w, d);
      return put(0, whole(d.by_q), n * n);
    default: {
      CentroidalMaps<S> maps;
      maps.Ag = s.maps[0];
      maps.rates = b.task != Task::centroidal_map;
      if (b.task == Task::centroidal_rate) maps.dAg = s.maps[1];
      if (b.task == Task::centroidal_derivatives) {
        maps.dh_dq = s.maps[2];
        maps.dhdot_dq = s.maps[3];
        maps.dhdot_dv = s.maps[4];
      }
      if (maps.rates) {
        evaluateSubspaceDerivatives(m, d, s.q, s.v);
        derivativesOutward(bodies, w, d, Vec3<S>{}, s.v, s.a, none);
        derivativesInward(bodies, w, d);
      } else {
        momenta(bodies, w, d, s.v);
      }
      const CentroidalState<S> state = kernels::centroidal(bodies, w, d, maps);
      if (b.task == Task::centroidal_derivatives) {
        for (int k = 0; k < 3; ++k) put(k, s.maps[2 + k], 6 * n);
        return put(3, s.maps[0], 6 * n);
      }
      put(0, reinterpret_cast<const S*>(&state.momentum), 6);
      if (b.task == Task::centroidal_map) return put(1, s.maps[0], 6 * n);
      put(1, reinterpret_cast<const S*>(&state.rate), 6);
      put(2, s.maps[0], 6 * n);
      return put(3, s.maps[1], 6 * n);
    }
  }
}

template <class S, class T = Real<S>>
void runBlock(const CompactImpl& m, char* scratch, Block<T>& b) {
  BlockScratch<S>& s = *reinterpret_cast<BlockScratch<S>*>(scratch);
  Workspace<S>& w = s.w;
  const Bodies<S> bodies{m, w};
  loadColumns(b.q, m.nqx, s.q);
  loadColumns(b.v, m.nvx, s.v);
  loadColumns(b.a, m.nvx, s.a);
  const bool poses_only =
      b.task == Task::mass_matrix || b.task == Task::joint_jacobians || b.task == Task::frame_jacobian || b.task == Task::minverse;
  evaluateJoints(m, w, s.q, poses_only ? nullptr : s.v);
  switch (b.task) {
    case Task::kinematics: {
      Workspace<S> out = w;
      out.oM = static_cast<SE3<S>*>(b.poses);
      out.oM[0] = {};
      if (b.velocities) out.v = static_cast<Motion<S>*>(b.velocities);
      if (b.accelerations) out.a = static_cast<Motion<S>*>(b.accelerations);
      kernels::forwardKinematics(bodies, out, b.velocities ? s.v : nullptr, b.accelerations ? s.a : nullptr);
      b.not_finite = !allFinite(reinterpret_cast<const S*>(out.oM), 12 * static_cast<std::ptrdiff_t>(m.bodies()));
      return;
    }
    case Task::joint_jacobians:
    case Task::frame_jacobian: {
      const std::ptrdiff_t n = 6 * static_cast<std::ptrdiff_t>(m.nvx);
      if (b.task == Task::joint_jacobians) {
        kernels::jointJacobians(bodies, w, s.J);
      } else {
        kernels::forwardKinematics(bodies, w, static_cast<const S*>(nullptr), static_cast<const S*>(nullptr));
        frameJacobian(bodies, w, {b.frame.body, cast<S>(b.frame.placement)}, b.reference, s.J, 6);
      }
      storeColumns(s.J, n, b.q.states, b.results[0]);
      b.not_finite = !allFinite(s.J, n);
      return;
    }
    case Task::rnea:
      rneaOutward(bodies, w, s.v, s.a, static_cast<const Force<S>*>(nullptr));
      rneaInward(bodies, w, s.result);
      addArmature(m, s.a, s.result);
      addLosses(m, 1.0, s.v, s.result);
      break;
    case Task::mass_matrix: {
      const std::ptrdiff_t n = static_cast<std::ptrdiff_t>(m.nvx) * m.nvx;
      kernels::massMatrix(bodies, w, s.M);
      storeColumns(s.M, n, b.q.states, b.results[0]);
      b.not_finite = !allFinite(s.M, n);
      return;
    }
    case Task::rnea_derivatives:
    case Task::aba_derivatives:
    case Task::minverse:
    case Task::coriolis:
    case Task::centroidal_map:
    case Task::centroidal_rate:
    case Task::centroidal_derivatives:
      return runDerivatives(m, s, b);
    case Task::aba:
      addLosses(m, -1.0, s.v, s.a);
      abaOutward(bodies, w, s.v, static_cast<const Force<S>*>(nullptr));
      abaInward(bodies, w, s.a);
      abaSolve(bodies, w, s.result);
      for (int l = 0; l < b.q.states; ++l) b.failed[l] = w.failed[l];
      break;
  }
  storeColumns(s.result, m.nvx, b.q.states, b.results[0]);
  b.not_finite = !allFinite(s.result, m.nvx);
}

template <class S>
BlockKernels<Real<S>> blockKernels() {
  using T = Real<S>;
  BlockKernels<T> k;
  k.lanes = lanes_of<S>;
  k.bytes = [](const CompactImpl& m, Room room) {
    BlockScratch<S> counted;
    return sizeof(BlockScratch<S>) + Arena::alignment + BlockScratch<S>::carve(counted, m, room, nullptr);
  };
  k.prepare = [](const CompactImpl& m, Room room, char* scratch) {
    constexpr std::size_t head = (sizeof(BlockScratch<S>) + Arena::alignment - 1) / Arena::alignment * Arena::alignment;
    auto* s = new (scratch) BlockScratch<S>;
    BlockScratch<S>::carve(*s, m, room, scratch + head);
    atRest(s->w);
    if (room.mass_matrix) std::fill(s->M, s->M + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, S(0));
  };
  k.run = [](const CompactImpl& m, char* scratch, Block<T>& block) { runBlock<S>(m, scratch, block); };
  return k;
}

}  // namespace dyn::kernels
