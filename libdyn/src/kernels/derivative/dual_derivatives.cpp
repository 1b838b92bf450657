// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/derivative/dual_derivatives.hpp"

#include "at.hpp"
#include "joint/pose_components.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"

#include <algorithm>

namespace dyn::kernels {

using D = Dual<double>;

namespace {

void copyValues(const double* from, std::ptrdiff_t count, D* to) {
  for (std::ptrdiff_t i = 0; i < count; ++i) to[i] = D(from[i], 0.0);
}

/// Column k of a joint's motion subspace, in the moving frame.
Motion<double> columnOf(const Bodies<double>& bodies, int i, int k) {
  const BodyIndex& x = bodies.index(i);
  const TypeBatch& batch = bodies.m.batches[at(x.batch)];
  const Run here{batch.shape, batch.nv, i, 1, x.batch, x.slot};
  Motion<double> column;
  withShape<double>(batch.shape, batch.nv, [&]<class Joint>() {
    const Slot<double> slot = bodies.slotOf(here, 0);
    column = Joint(slot).column(k);
  });
  return column;
}

/// Writes how the pose and, where it varies, the subspace of body i's joint change along its k-th degree of freedom. sign 0 sets the change to zero.
void setChange(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i, int k,
               double sign, DualState& s) {
  const Bodies<double> bodies{m, const_cast<Workspace<double>&>(w)};
  const BodyIndex& x = m.index[at(i)];
  const TypeBatch& batch = m.batches[at(x.batch)];
  const JointMemory<double>& from = w.joints[x.batch];
  const JointMemory<D>& to = s.w.joints[x.batch];
  const int size = poseSize(batch.shape);
  double components[12], change[12] = {};
  for (int c = 0; c < size; ++c) components[c] = from.pose[c * from.stride + x.slot];
  const SE3<double> pose = poseFromComponents(batch.shape, components);
  const Motion<double> S = columnOf(bodies, i, k);
  componentsOfPose(batch.shape, pose.R * skew(S.angular), pose.R * S.linear, change);
  for (int c = 0; c < size; ++c) to.pose[c * to.stride + x.slot].d = sign * change[c];
  if (batch.shape != Shape::dense) return;

  const SubspaceDerivatives<double>& once = d.subspaces[x.batch];
  const SubspaceDerivatives<D>& twice = s.d.subspaces[x.batch];
  const auto enter = [&](const Motion<double>& rate, D* base, std::ptrdiff_t stride) {
    for (int c = 0; c < 3; ++c) {
      base[c * stride + x.slot].d = sign * rate.linear[c];
      base[(3 + c) * stride + x.slot].d = sign * rate.angular[c];
    }
  };
  for (int l = 0; l < x.nv; ++l) enter(once.column(x.nv, k, l, x.slot), to.subspace + 6 * l * to.stride, to.stride);
  enter(once.biasRate(k, x.slot), to.bias, to.stride);
  // Second derivatives from the joint type's own code: the inner dual number moves along `along`, the outer one along k.
  Dual<D>*twice_q = s.twice, *twice_v = twice_q + x.nq, *pose_out = twice_v + x.nv, *subspace = pose_out + 12, *bias = subspace + 6 * x.nv;
  JointBatch<Dual<D>> call;
  call.count = 1;
  call.constants = batch.constants.data() + x.slot;
  call.constant_count = batch.constant_count;
  call.constants_stride = batch.count;
  call.stride = call.q_stride = call.v_stride = 1;
  call.q = twice_q;
  call.v = twice_v;
  call.pose = pose_out;
  call.subspace = subspace;
  call.bias = bias;
  D moving_q[max_joint_nq], unit[max_joint_nv], dq[max_joint_nq];
  const auto ratesAlong = [&](int direction) {
    for (int c = 0; c < x.nv; ++c) unit[c] = c == direction ? 1.0 : 0.0;
    coordinateRates(batch, x.slot, 1, 1, moving_q, unit, dq);
  };
  if (sign != 0) {
    for (int c = 0; c < x.nq; ++c) moving_q[c] = q[x.idx_q + c];
    ratesAlong(k);
    for (int c = 0; c < x.nq; ++c) moving_q[c].d = dq[c].v;
  }
  for (int along = 0; along < x.nv; ++along) {
    if (sign != 0) ratesAlong(along);
    for (int c = 0; c < x.nq && sign != 0; ++c) twice_q[c] = Dual<D>(D(moving_q[c].v, dq[c].v), D(moving_q[c].d, dq[c].d));
    for (int c = 0; c < x.nv && sign != 0; ++c) twice_v[c] = Dual<D>(D(v[x.idx_v + c], 0.0), D(0.0, 0.0));
    if (sign != 0) batch.type->kinematics(call);
    for (int c = 0; c < 6 * x.nv; ++c) twice.columns[(6 * x.nv * along + c) * twice.stride + x.slot].d = sign != 0 ? subspace[c].d.d : 0.0;
    for (int c = 0; c < 6; ++c) twice.bias[(6 * along + c) * twice.stride + x.slot].d = sign != 0 ? bias[c].d.d : 0.0;
  }
}

void changesOf(const CompactImpl& m, const PathMatrix<D>& matrix, D* scratch, double* out) {
  matrix.assemble<D>(m.dof_end, Rows<D>{scratch, m.nvx});
  const std::ptrdiff_t n = m.nvx;
  for (std::ptrdiff_t i = 0; i < n * n; ++i) out[i] = scratch[i].d;
}

}  // namespace

void moveAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i, int k,
               DualState& s) {
  setChange(m, w, d, q, v, i, k, 1, s);
}

void standStill(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, int i, int k, DualState& s) {
  setChange(m, w, d, nullptr, nullptr, i, k, 0, s);
}

void layOut(DualState& s, const CompactImpl& m, Arena& arena) {
  dyn::layOut(s.w, m, arena);
  layOut(s.d, m, arena);
  const auto n = static_cast<std::size_t>(m.nvx);
  arena.take(s.v, n);
  arena.take(s.a, n);
  arena.take(s.matrix, n * n);
  arena.take(s.twice, max_joint_nq + 7 * max_joint_nv + 18);
}

void loadState(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* v, const double* a,
               DualState& s) {
  atRest(s.w);
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const std::ptrdiff_t count = w.joints[b].stride;
    copyValues(w.joints[b].pose, poseSize(batch.shape) * count, s.w.joints[b].pose);
    if (batch.shape != Shape::dense) continue;
    copyValues(w.joints[b].subspace, 6 * batch.nv * count, s.w.joints[b].subspace);
    copyValues(w.joints[b].bias, 6 * count, s.w.joints[b].bias);
    copyValues(d.subspaces[b].columns, static_cast<std::ptrdiff_t>(6) * batch.nv * batch.nv * batch.count, s.d.subspaces[b].columns);
    copyValues(d.subspaces[b].bias, static_cast<std::ptrdiff_t>(6) * batch.nv * batch.count, s.d.subspaces[b].bias);
  }
  copyValues(v, m.nvx, s.v);
  copyValues(a, m.nvx, s.a);
}

void derivativesAlong(const CompactImpl& m, const Workspace<double>& w, const DerivativeWorkspace<double>& d, const double* q, const double* v, int i,
                      int k, DualState& s, double* by_q, double* by_v, double* by_a) {
  moveAlong(m, w, d, q, v, i, k, s);
  rneaDerivatives<D>(m, s.w, s.d, s.v, s.a);
  changesOf(m, s.d.by_q, s.matrix, by_q);
  changesOf(m, s.d.by_v, s.matrix, by_v);
  changesOf(m, s.d.by_a, s.matrix, by_a);
  standStill(m, w, d, i, k, s);
}

}  // namespace dyn::kernels
