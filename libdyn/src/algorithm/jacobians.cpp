// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/recursion/jacobians.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/jacobians.hpp>

#include <algorithm>

namespace dyn {

namespace {

using kernels::seen;
using kernels::Walk;

/// The time derivative of seen(walk, S), where dS is the derivative of S in the body's axes.
Motion<double> seenRate(const Walk<double>& walk, const Motion<double>& S, const Motion<double>& dS) {
  const Vec3<double>& w = walk.rate.angular;
  const Vec3<double> arm = S.linear + cross(S.angular, walk.x);
  return {walk.Q * (dS.linear + cross(dS.angular, walk.x) + cross(S.angular, walk.rate.linear) - cross(w, arm)),
          walk.Q * (dS.angular - cross(w, S.angular))};
}

/// Writes d.rel and d.oM from joints that have been evaluated.
void place(const CompactImpl& m, DataImpl& d) {
  kernels::active().single.forwardKinematics(m, d, nullptr, nullptr);
  d.stage = std::max(d.stage, KinematicsStage::poses);
}

/// Copies the user's columns of a folded matrix that has a column for each expanded coordinate.
void keepColumns(const kernels::DependentJoints<double>& dependents, const double* expanded, const MatrixOut& user) {
  for (int k = 0; k < dependents.m.nv; ++k) std::copy_n(expanded + 6 * dependents.m.v_of_user[at(k)], 6, user.column(k));
}

/// Writes J from joints that have been evaluated and placed. Throws Error(argument) for a reference that does not exist.
void writeJacobian(const CompactImpl& m, DataImpl& d, const PointOnBody& point, ReferenceFrame reference, const MatrixOut& J) {
  checkReference(reference);
  const bool coupled = !m.couplings.empty();
  const MatrixOut out = coupled ? MatrixOut(d.columns, 6, m.nvx) : J;
  kernels::frameJacobian<double>({m, d}, d, {point.body, point.placement}, reference, out.column(0), out.stride());
  if (!coupled) return;
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.fold(6, d.columns);
  keepColumns(dependents, d.columns, J);
}

PointOnBody pointOf(const CompactModel& model, detail::Kind kind, int id) {
  return kind == detail::Kind::joint ? jointOnBody(model, id) : frameOnBody(model, id);
}

}  // namespace

namespace detail {

void jacobian(const CompactModel& model, Data& data, VectorView q, Kind kind, int id, ReferenceFrame reference, const MatrixOut& J) {
  const PointOnBody point = pointOf(model, kind, id);
  const char* algorithm = kind == Kind::joint ? "computeJointJacobian" : "computeFrameJacobian";
  checkShape(algorithm, "J", J, 6, model.nv());
  const Inputs in = readInputs(algorithm, model, data, q, nullptr, nullptr);
  evaluateJoints(model.impl(), data.impl(), in.q, nullptr);
  place(model.impl(), data.impl());
  writeJacobian(model.impl(), data.impl(), point, reference, J);
}

const double* jointJacobians(const CompactModel& model, Data& data, VectorView q) {
  const Inputs in = readInputs("computeJointJacobians", model, data, q, nullptr, nullptr);
  const CompactImpl& m = model.impl();
  refuseDependentJoints("computeJointJacobians", m);
  DataImpl& d = data.impl();
  evaluateJoints(m, d, in.q, nullptr);
  kernels::active().single.jointJacobians(m, d, d.J);
  d.stage = std::max(d.stage, KinematicsStage::poses);
  return d.J;
}

void jacobianTimeVariation(const CompactModel& model, Data& data, VectorView q, VectorView v, Kind kind, int id, ReferenceFrame reference,
                           const MatrixOut& dJ) {
  checkReference(reference);
  const PointOnBody point = pointOf(model, kind, id);
  const char* algorithm = kind == Kind::joint ? "computeJointJacobianTimeVariation" : "computeFrameJacobianTimeVariation";
  checkShape(algorithm, "dJ", dJ, 6, model.nv());
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, &v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  evaluateSubspaceRates(m, d, in.q, in.v);
  place(m, d);
  const SE3<double> oMf = d.oM[point.body] * point.placement;
  // LOCAL differs from the other references by the frame's velocity. The same walk sums it up, so the walk runs twice.
  double *base = d.columns + 6 * m.nvx, *rates = d.columns;
  const bool coupled = !m.couplings.empty();
  const MatrixOut out = coupled ? MatrixOut(rates, 6, m.nvx) : dJ;
  for (int k = 0; k < m.nvx; ++k) std::fill_n(out.column(k), 6, 0.0);
  std::fill_n(base, 6 * m.nvx, 0.0);
  const kernels::Bodies<double> bodies{m, d};
  const kernels::FramePoint<double> frame{point.body, point.placement};
  Walk<double> walk;
  Motion<double> vf;
  walkSupports(bodies, d, frame, in.v, walk, [&](int i, int k, const Motion<double>& S) { vf += in.v[bodies.index(i).idx_v + k] * seen(walk, S); });
  walkSupports(bodies, d, frame, in.v, walk, [&](int i, int k, const Motion<double>& S) {
    const int iv = bodies.index(i).idx_v + k;
    Motion<double> rate = seenRate(walk, S, subspaceRate(m, d, i, k));
    const Motion<double> c = seen(walk, S);
    // d/dt (X c) = X (dc + v x c) for X into the reference. v is the frame's velocity for WORLD, its angular part for LOCAL_WORLD_ALIGNED.
    if (reference == ReferenceFrame::WORLD) rate += vf.cross(c);
    if (reference == ReferenceFrame::LOCAL_WORLD_ALIGNED) rate += Motion<double>{cross(vf.angular, c.linear), cross(vf.angular, c.angular)};
    kernels::writeMotion(express(rate, oMf, reference), out.column(iv));
    kernels::writeMotion(express(c, oMf, reference), base + 6 * iv);
  });
  if (!coupled) return;
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.foldWithRate(6, base, rates);
  keepColumns(dependents, rates, dJ);
}

}  // namespace detail

void getJointJacobian(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& J) {
  checkData("getJointJacobian", model, data);
  checkStage("getJointJacobian", data.impl().stage, KinematicsStage::poses);
  checkShape("getJointJacobian", "J", J, 6, model.nv());
  writeJacobian(model.impl(), data.impl(), jointOnBody(model, joint), reference, J);
}

void getFrameJacobian(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& J) {
  checkData("getFrameJacobian", model, data);
  checkStage("getFrameJacobian", data.impl().stage, KinematicsStage::poses);
  checkShape("getFrameJacobian", "J", J, 6, model.nv());
  writeJacobian(model.impl(), data.impl(), frameOnBody(model, frame), reference, J);
}

}  // namespace dyn
