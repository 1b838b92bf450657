#include "algorithm/crba.hpp"
#include "algorithm/external.hpp"
#include "kernels/aligned.hpp"

#include <dyn/algorithm/aba.hpp>

#include <cmath>
#include <limits>

namespace dyn::detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

[[noreturn]] void singular(const std::string& joint) {
  throw Error(ErrorCode::singular,
              "aba: the mass matrix is singular here: what this joint moves has no inertia along its motion; give its bodies mass, give the "
              "joint armature, or lock it",
              {"", 0, joint});
}

/// Poses, velocity-dependent accelerations, rigid inertias and bias forces. Classical accelerations: linear velocities do not enter.
void outward(const CompactImpl& m, DataImpl& d, const double* v, const Force<double>* fext) {
  d.w[0] = {};
  kernels::forward(m, d, [&]<class Joint>(const Joint& joint, int i, int iv) {
    const BodyConstants& c = m.constants[at(i)];
    const int p = m.index[at(i)].parent;
    kernels::placeAligned(joint, c.placement, i, m.index[at(i)], d);
    const Mat3<double>& R = d.R[i];
    const Vec3<double>& wp = d.w[p];
    const Motion<double> s = joint.times(v + iv);

    Vec3<double> w = wp;
    Motion<double> beta{cross(wp, cross(wp, d.r[i])), {}};
    if constexpr (Joint::has_angular) {
      const Vec3<double> sw = R * s.angular;
      w += sw;
      beta.angular += cross(wp, sw);
    }
    if constexpr (Joint::has_linear) beta.linear += cross(wp + w, R * s.linear);
    if constexpr (Joint::has_bias) {
      const Motion<double> b = joint.bias();
      beta += {R * b.linear, R * b.angular};
    }
    d.w[i] = w;
    d.beta[i] = beta;

    const Vec3<double> h = R * c.h;
    const Sym3<double> I = congruence(R, c.origin);
    d.IA[i] = ArticulatedInertia<double>::rigid(c.mass, h, I);
    d.pA[i] = {cross(w, cross(w, h)), cross(w, I * w)};
    if (fext) d.pA[i] -= Force<double>{R * fext[i].linear, R * fext[i].angular};
    for (int k = 0; k < Joint::nv; ++k) d.dof[iv + k].S = kernels::alignedColumn(joint, k, R);
  });
}

/// A pivot that is not above the rounding of what was subtracted to get it is zero. The yardstick is the inertia left in other
/// directions at the same body, so it scales with the model's units.
bool vanishes(double d, const Motion<double>& S, const ArticulatedInertia<double>& I) {
  const double linear = I.linear.xx + I.linear.yy + I.linear.zz, angular = I.angular.xx + I.angular.yy + I.angular.zz;
  const double yardstick = dot(S.linear, S.linear) * linear + dot(S.angular, S.angular) * angular;
  return !(d > 4 * std::numeric_limits<double>::epsilon() * yardstick) || !std::isfinite(d);
}

/// Eliminates each degree of freedom (pivot S^T IA S + armature), projects inertia and bias force, hands them to the parent.
void inward(const CompactImpl& m, DataImpl& d, const double* tau) {
  kernels::backward(m, d, [&]<class Joint>(const Joint&, int i, int iv) {
    constexpr int nv = Joint::nv;
    ArticulatedInertia<double>& IA = d.IA[i];
    Force<double>& pA = d.pA[i];
    DofFactor* dof = d.dof + iv;
    // Eliminating one direction after the other is the factorisation: each updates IA, so the next pivot is read off it.
    for (int k = 0; k < nv; ++k) {
      const Force<double> U = IA * dof[k].S;
      const double armature = m.armature.empty() ? 0.0 : m.armature[at(iv + k)];
      const double pivot = dot(dof[k].S, U) + armature;
      if (vanishes(pivot, dof[k].S, IA)) singular(m.joints[at(m.index[at(i)].joint)].name);
      dof[k].d = pivot;
      dof[k].W = U;
      dof[k].y = tau[iv + k] - dot(dof[k].S, pA);
      IA.subtractOuter(U, (1 / pivot) * U);
      pA += (dof[k].y / pivot) * U;
    }
    const int p = m.index[at(i)].parent;
    if (p > 0) {
      pA += IA * d.beta[i];
      d.IA[p] += IA.shifted(d.r[i]);
      d.pA[p] += {pA.linear, pA.angular + cross(d.r[i], pA.linear)};
    }
  });
}

/// Accelerations, parents first; within a joint in the reverse order of elimination.
void solve(const CompactImpl& m, DataImpl& d, double* ddq) {
  d.acc[0] = {};
  kernels::forward(m, d, [&]<class Joint>(const Joint&, int i, int iv) {
    const int p = m.index[at(i)].parent;
    Motion<double> a = d.acc[p];
    if (p == 0) {
      a.linear = kernels::isFlyingRoot<Joint>(p) ? transposeTimes(d.rel[i].R, -m.gravity) : -m.gravity;
    } else {
      a.linear += cross(a.angular, d.r[i]);
    }
    a += d.beta[i];
    for (int k = Joint::nv - 1; k >= 0; --k) {
      const DofFactor& f = d.dof[iv + k];
      ddq[iv + k] = (f.y - dot(a, f.W)) / f.d;
      a += ddq[iv + k] * f.S;
    }
    d.acc[i] = a;
  });
}

/// In-place solution of M x = b by square-root-free Cholesky from the leaves to the root (Featherstone 2008, ch. 8); couplings connect
/// distant joints, so M is taken as dense. A pivot of the rounding of its diagonal's size is zero.
void solveDense(const CompactImpl& m, double* M, double* x, double* diagonal) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = 0; k < n; ++k) diagonal[k] = M[k * n + k];
  for (std::ptrdiff_t k = n - 1; k >= 0; --k) {
    const double pivot = M[k * n + k];
    if (!(pivot > 8 * std::numeric_limits<double>::epsilon() * diagonal[k]) || !std::isfinite(pivot)) {
      std::size_t joint = m.joints.size() - 1;
      while (m.joints[joint].idx_v > k || m.joints[joint].nv == 0) --joint;
      singular(m.joints[joint].name);
    }
    for (std::ptrdiff_t i = 0; i < k; ++i) {
      const double l = M[k * n + i] / pivot;
      if (l == 0) continue;
      for (std::ptrdiff_t j = 0; j <= i; ++j) M[i * n + j] -= l * M[k * n + j];
      x[i] -= l * x[k];
    }
  }
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double sum = x[k];
    for (std::ptrdiff_t i = 0; i < k; ++i) sum -= M[k * n + i] * x[i];
    x[k] = sum / M[k * n + k];
  }
}

}  // namespace

const double* aba(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext, std::size_t count) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (!m.couplings.empty()) {
    checkData("aba of a model with coupled joints", model, data, Need::mass_matrix);
    checkSize("aba", "tau", tau, m.nv);
    const VectorView zero{d.zero, m.nv};
    const double* bias = rnea(model, data, q, v, zero, fext, count);
    for (int k = 0; k < m.nv; ++k) d.ddq[k] = tau.data[k] - bias[k];
    massMatrix(m, d);
    solveDense(m, d.M, d.ddq, d.ax);
    return d.ddq;
  }
  const Inputs in = readInputs("aba", model, data, q, &v, nullptr);
  checkSize("aba", "tau", tau, m.nv);
  const Force<double>* external = readExternalForces("aba", m, d, fext, count);
  evaluateJoints(m, d, in.q, in.v);
  outward(m, d, in.v, external);
  const double* effective = tau.data;
  if (!m.damping.empty() || !m.friction.empty()) {
    for (int k = 0; k < m.nv; ++k) d.tau[k] = 0;
    addLosses(m, in.v, d.tau);
    for (int k = 0; k < m.nv; ++k) d.tau[k] = tau.data[k] - d.tau[k];
    effective = d.tau;
  }
  inward(m, d, effective);
  solve(m, d, d.ddq);
  return d.ddq;
}

}  // namespace dyn::detail
