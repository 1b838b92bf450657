// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/jacobians.hpp"

#include <dyn/algorithm/kinematics_derivatives.hpp>

namespace dyn {

namespace {

/// How the motion of a body, in axes fixed to that body, changes with one degree of freedom of a joint between it and the world, in addition to the
/// effect of rigid rotation. In the axes of the joint's body, at its origin.
struct Variation {
  Motion<double> column;                        ///< of the motion subspace
  Motion<double> velocity, acceleration, rate;  ///< of the velocity by q, of the acceleration by q, of the acceleration by v
};

/// By q: dv = v_p x s + E, da = a_p x s + v_p x dv + v x E + A + H; by v: da = dv + ds/dt. p is the parent. See rnea_derivatives.hpp.
Variation variationOf(const CompactImpl& m, const DataImpl& d, const Motion<double>& s, int i, int k) {
  const BodyIndex& x = m.index[at(i)];
  const TypeBatch& batch = m.batches[at(x.batch)];
  const double *v = d.kinematics_v + x.idx_v, *a = d.kinematics_a + x.idx_v;
  Variation out{s, {}, {}, {}};
  // The parent's motion at this body's origin.
  const Motion<double> vp = d.rel[i].actInv(d.v[x.parent]), ap = d.rel[i].actInv(d.a[x.parent]);
  out.velocity = vp.cross(s);
  out.rate = d.v[i].cross(s);
  if (batch.shape == Shape::dense) {
    const auto& dS = d.derivatives.subspaces[x.batch];
    Motion<double> E, more = dS.biasRate(k, x.slot);
    for (int l = 0; l < x.nv; ++l) {
      const Motion<double> along = dS.column(x.nv, k, l, x.slot);
      E += v[l] * along;
      more += a[l] * along;
      out.rate += v[l] * dS.column(x.nv, l, k, x.slot);
    }
    out.velocity += E;
    out.acceleration = more + d.v[i].cross(E);
  }
  out.acceleration += ap.cross(s) + vp.cross(out.velocity);
  out.rate += out.velocity;
  return out;
}

/// How the motion m, expressed in the reference, changes because the body moves along s: s x m for WORLD, the angular part of s on m for
/// LOCAL_WORLD_ALIGNED, and not at all for LOCAL.
Motion<double> carried(const Motion<double>& s, const Motion<double>& m, ReferenceFrame reference) {
  if (reference == ReferenceFrame::WORLD) return s.cross(m);
  if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) return {cross(s.angular, m.linear), cross(s.angular, m.angular)};
  return {};
}

/// Writes the derivatives of velocity by q and v, and of acceleration by q, v and a. computeForwardKinematicsDerivatives must have run before. Each
/// has room for nvx columns of 6 numbers, and the user's degrees of freedom come first.
void motionDerivatives(const CompactImpl& m, DataImpl& d, const PointOnBody& point, ReferenceFrame reference, double* const columns[5]) {
  const SE3<double> oMf = d.oM[point.body] * point.placement;
  const Motion<double> v = point.placement.actInv(d.v[point.body]), a = point.placement.actInv(d.a[point.body]);
  for (int r = 0; r < 5; ++r) std::fill_n(columns[r], 6 * m.nvx, 0.0);
  kernels::Walk<double> walk;
  kernels::walkSupports<double>({m, d}, d, {point.body, point.placement}, nullptr, walk, [&](int i, int k, const Motion<double>& S) {
    const Variation x = variationOf(m, d, S, i, k);
    const Motion<double> s = kernels::seen(walk, x.column), dv = kernels::seen(walk, x.velocity);
    const Motion<double> results[5] = {dv + carried(s, v, reference), s, dv.cross(v) + kernels::seen(walk, x.acceleration) + carried(s, a, reference),
                                       s.cross(v) + kernels::seen(walk, x.rate), s};
    for (int r = 0; r < 5; ++r) kernels::writeMotion(express(results[r], oMf, reference), columns[r] + 6 * (m.index[at(i)].idx_v + k));
  });
  if (!m.couplings.empty()) {
    double* none = d.columns;
    std::fill_n(none, 6 * m.nvx, 0.0);
    const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
    dependents.foldDerivatives(6, columns[0], columns[1], none);
    dependents.foldDerivatives(6, columns[2], columns[3], columns[4]);
    for (int r = 0; r < 5; ++r) dependents.keep(6, columns[r], columns[r]);
  }
}

}  // namespace

namespace detail {

void forwardKinematicsDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a) {
  checkData("computeForwardKinematicsDerivatives", model, data, Need::derivatives);
  forwardKinematics(model, data, q, &v, &a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const bool coupled = !m.couplings.empty();
  const double* expanded_q = coupled ? d.qx : q.data;
  std::copy_n(coupled ? d.vx : v.data, m.nvx, d.kinematics_v);
  std::copy_n(coupled ? d.ax : a.data, m.nvx, d.kinematics_a);
  kernels::active().single.evaluateSubspaces(m, d.derivatives, expanded_q, d.kinematics_v);
  d.stage = KinematicsStage::derivatives;
}

void motionDerivatives(const CompactModel& model, Data& data, Subject subject, int id, ReferenceFrame reference, const MatrixOut* v_dq,
                       const MatrixOut* v_dv, const MatrixOut* a_dq, const MatrixOut* a_dv, const MatrixOut* a_da) {
  const char* algorithm = a_dq ? "getAccelerationDerivatives" : "getVelocityDerivatives";
  checkData(algorithm, model, data, Need::derivatives);
  checkStage(algorithm, data.impl().stage, KinematicsStage::derivatives);
  const std::pair<const char*, const MatrixOut*> outputs[] = {{"v_dq", v_dq}, {"v_dv", v_dv}, {"a_dq", a_dq}, {"a_dv", a_dv}, {"a_da", a_da}};
  for (const auto& [name, matrix] : outputs)
    if (matrix) checkShape(algorithm, name, *matrix, 6, model.nv());
  checkReference(reference);
  const PointOnBody point = subject == Subject::joint ? jointOnBody(model, id) : frameOnBody(model, id);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  double* const columns[5] = {d.Ag, d.dAg, d.dh_dq, d.dhdot_dq, d.dhdot_dv};
  dyn::motionDerivatives(m, d, point, reference, columns);
  for (int r = 0; r < 5; ++r)
    if (const MatrixOut* out = outputs[r].second)
      for (int k = 0; k < m.nv; ++k) std::copy_n(columns[r] + 6 * k, 6, out->column(k));
}

}  // namespace detail

}  // namespace dyn
