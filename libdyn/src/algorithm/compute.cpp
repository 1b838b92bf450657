#include "algorithm/centroidal.hpp"
#include "algorithm/derivatives.hpp"
#include "algorithm/inputs.hpp"
#include "algorithm/sums.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/compute.hpp>
#include <dyn/algorithm/coriolis.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/jacobians.hpp>
#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>

namespace dyn::detail {

namespace {

using Q = Quantity;

/// How far kinematics go: -1 not at all, 0 placements, 1 velocities, 2 accelerations.
int kinematicOrder(Quantity what) {
  if (has(what, Q::accelerations)) return 2;
  if (has(what, Q::velocities | Q::energies)) return 1;
  return has(what, Q::placements | Q::center_of_mass) ? 0 : -1;
}

void sums(const CompactImpl& m, const DataImpl& d, Quantity what, int order, const double* v, ComputedViews& out) {
  if (has(what, Q::center_of_mass)) out.center_of_mass = sumCenterOfMass(m, d, order > 0, order > 1);
  if (!has(what, Q::energies)) return;
  out.kinetic_energy = sumKineticEnergy(m, d, v);
  out.potential_energy = sumPotentialEnergy(m, d);
}

/// Followers' columns are folded into their masters' by each algorithm in its own way: they run one after the other.
ComputedViews separately(const CompactModel& model, Data& data, Quantity what, VectorView q, VectorView v, VectorView a) {
  ComputedViews out;
  Passes& passes = out.passes;
  const auto counted = [&](int& pass) {
    ++pass;
    ++passes.joints;
  };
  const int order = kinematicOrder(what);
  if (order >= 0) {
    forwardKinematics(model, data, q, order > 0 ? &v : nullptr, order > 1 ? &a : nullptr);
    sums(model.impl(), data.impl(), what, order, data.impl().vx, out);
    counted(passes.kinematics);
  }
  if (has(what, Q::joint_jacobians)) out.J = jointJacobians(model, data, q);  // says why there is none
  const auto dynamics = [&](Quantity one, const double*& result, auto&& run) {
    if (!has(what, one)) return;
    result = run();
    counted(passes.dynamics);
  };
  dynamics(Q::rnea, out.tau, [&] { return rnea(model, data, q, v, a, nullptr, 0); });
  dynamics(Q::nle, out.nle, [&] { return nonLinearEffects(model, data, q, v); });
  dynamics(Q::gravity, out.gravity, [&] { return generalizedGravity(model, data, q); });
  if (has(what, Q::rnea_derivatives)) {
    const DerivativeViews x = rneaDerivatives(model, data, q, &v, &a, nullptr, 0);
    out.dtau_dq = x.by_q;
    out.dtau_dv = x.by_v;
    out.M = x.inertia;
    counted(passes.derivatives);
  } else if (has(what, Q::mass_matrix)) {
    out.M = crba(model, data, q);
    counted(passes.inertias);
  }
  if (has(what, Q::minverse)) {
    out.Minv = minverse(model, data, q);
    counted(passes.inertias);
  }
  if (has(what, Q::coriolis)) {
    out.C = coriolisMatrix(model, data, q, v);
    counted(passes.derivatives);
  }
  if (has(what, Q::centroidal_map | Q::centroidal_rate)) {
    const bool rate = has(what, Q::centroidal_rate);
    const CentroidalViews x = centroidal(model, data, rate ? CentroidalTask::rate : CentroidalTask::map, q, v, rate ? &a : nullptr);
    out.hg = x.hg;
    out.Ag = x.Ag;
    if (rate) {
      out.dhg = x.dhg;
      out.dAg = x.dAg;
    }
    counted(rate ? passes.derivatives : passes.inertias);
  }
  return out;
}

}  // namespace

ComputedViews compute(const CompactModel& model, Data& data, Quantity what, VectorView q, VectorView v, VectorView a) {
  if (has(what, Q::mass_matrix)) checkData("compute: the mass matrix", model, data, Need::mass_matrix);
  if (has(what, Q::minverse | Q::coriolis | Q::centroidal_map | Q::centroidal_rate | Q::rnea_derivatives))
    checkData("compute", model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  keepArguments(data, {.q = &q, .v = &v, .a = &a});
  const Inputs in = readInputs("compute", model, data, q, &v, &a);
  if (!m.couplings.empty()) return separately(model, data, what, q, v, a);
  if (has(what, Q::centroidal_map | Q::centroidal_rate) && !(m.mass > 0))
    throw Error(ErrorCode::singular, "compute: the model has no mass, so no centre of mass; give its bodies inertias");

  const kernels::SingleKernels& k = kernels::active().single;
  ComputedViews out;
  Passes& passes = out.passes;
  if (static_cast<unsigned>(what) == 0) return out;
  constexpr Quantity by_velocity =
      Q::velocities | Q::accelerations | Q::energies | Q::rnea | Q::nle | Q::coriolis | Q::centroidal_map | Q::centroidal_rate | Q::rnea_derivatives;
  evaluateJoints(m, d, in.q, has(what, by_velocity) ? in.v : nullptr);
  ++passes.joints;
  constexpr Quantity by_subspaces = Q::coriolis | Q::centroidal_rate | Q::rnea_derivatives;
  if (has(what, by_subspaces)) {
    k.evaluateSubspaces(m, d.derivatives, in.q, in.v);
    ++passes.subspaces;
  }

  const int order = kinematicOrder(what);
  if (has(what, Q::joint_jacobians)) {
    k.jointJacobians(m, d, d.J);
    out.J = d.J;
    ++passes.kinematics;
  }
  if (order > 0 || (order == 0 && !has(what, Q::joint_jacobians))) {
    k.forwardKinematics(m, d, order > 0 ? in.v : nullptr, order > 1 ? in.a : nullptr);
    d.stage = order > 1 ? KinematicsStage::accelerations : order > 0 ? KinematicsStage::velocities : KinematicsStage::poses;
    ++passes.kinematics;
  }
  sums(m, d, what, order, in.v, out);

  const auto dynamics = [&](Quantity one, const double*& result, const double* velocity, const double* acceleration, double* to) {
    if (!has(what, one)) return;
    k.rnea(m, d, velocity, acceleration, nullptr, to);
    result = to;
    ++passes.dynamics;
  };
  dynamics(Q::rnea, out.tau, in.v, in.a, d.tau);
  dynamics(Q::nle, out.nle, in.v, d.zero, d.nle);
  if (has(what, Q::rnea_derivatives)) {
    k.rneaDerivatives(m, d, d.derivatives, in.v, in.a, nullptr, {d.dtau_dq, d.dtau_dv, d.M});
    out.dtau_dq = d.dtau_dq;
    out.dtau_dv = d.dtau_dv;
    out.M = d.M;
    ++passes.derivatives;
  } else if (has(what, Q::mass_matrix)) {
    k.massMatrix(m, d, d.M);
    out.M = d.M;
    ++passes.inertias;
  }
  if (has(what, Q::minverse)) {
    invertTreeInertia("compute", m, d, in.q);
    out.Minv = d.Minv;
    ++passes.inertias;
  }
  if (has(what, Q::coriolis)) {
    k.coriolis(m, d, d.derivatives, in.v, d.zero);
    k.assemble(m, d.derivatives.by_v, d.C);
    out.C = d.C;
    ++passes.derivatives;
  }
  if (has(what, Q::centroidal_map | Q::centroidal_rate)) {
    const bool rate = has(what, Q::centroidal_rate);
    const CentroidalViews x = centroidalOfEvaluated(m, d, rate ? CentroidalTask::rate : CentroidalTask::map, in.v, in.a);
    out.hg = x.hg;
    out.Ag = x.Ag;
    if (rate) {
      out.dhg = x.dhg;
      out.dAg = x.dAg;
    }
    ++(rate ? passes.derivatives : passes.inertias);
  }
  // At rest last: joints whose subspace varies have another bias there.
  if (has(what, Q::gravity) && has(what, by_velocity)) {
    bool varying = false;
    for (const TypeBatch& batch : m.batches) varying = varying || batch.shape == Shape::dense;
    if (varying) {
      evaluateJoints(m, d, in.q, d.zero);
      ++passes.joints;
    }
  }
  dynamics(Q::gravity, out.gravity, d.zero, d.zero, d.g);
  return out;
}

}  // namespace dyn::detail
