// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/centroidal.hpp"
#include "algorithm/derivatives.hpp"
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/sums.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/compute.hpp>
#include <dyn/algorithm/coriolis.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/jacobians.hpp>
#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>

#include <string>

namespace dyn::detail {

namespace {

using A = Algorithm;

AlgorithmViews inOrder(A algorithm, const CentroidalViews& x) {
  if (algorithm == A::centroidal_map) return {x.hg, x.Ag};
  if (algorithm == A::centroidal_rate) return {x.hg, x.dhg, x.Ag, x.dAg};
  return {x.dh_dq, x.dhdot_dq, x.dhdot_dv, x.Ag};
}

/// The kinematics that the set needs: -1 none, 0 placements, 1 velocities, 2 accelerations.
int kinematicOrder(Algorithms what) {
  if (has(what, A::accelerations)) return 2;
  if (has(what, A::velocities | A::energies)) return 1;
  return has(what, A::placements | A::center_of_mass) ? 0 : -1;
}

constexpr bool isKinematic(A algorithm) { return algorithm <= A::accelerations || algorithm == A::center_of_mass || algorithm == A::energies; }

/// Whether another algorithm of the set computes the same results anyway.
constexpr bool comesWithOthers(A algorithm, Algorithms what) {
  return (algorithm == A::mass_matrix && has(what, A::rnea_derivatives)) || (algorithm == A::centroidal_map && has(what, A::centroidal_rate));
}

void sums(const CompactImpl& m, DataImpl& d, Algorithms what, int order, const double* v, ComputedViews& out) {
  if (has(what, A::center_of_mass)) out.center_of_mass = sumCenterOfMass(m, d, order > 0, order > 1);
  if (!has(what, A::energies)) return;
  out.kinetic_energy = sumKineticEnergy(m, d, v);
  out.potential_energy = sumPotentialEnergy(m, d);
}

int& countOf(Passes& passes, Pass pass) {
  switch (pass) {
    case Pass::kinematics:
      return passes.kinematics;
    case Pass::dynamics:
      return passes.dynamics;
    case Pass::inertias:
      return passes.inertias;
    default:
      return passes.derivatives;
  }
}

/// Each algorithm folds the columns of dependent joints into their masters' in its own way, so the algorithms run one after the other.
ComputedViews separately(const CompactModel& model, Data& data, Algorithms what, VectorView q, VectorView v, VectorView a) {
  ComputedViews out;
  const auto count = [&](A algorithm) {
    ++countOf(out.passes, info(algorithm).pass);
    ++out.passes.joints;
  };
  const int order = kinematicOrder(what);
  if (order >= 0) {
    forwardKinematics(model, data, q, order > 0 ? &v : nullptr, order > 1 ? &a : nullptr);
    sums(model.impl(), data.impl(), what, order, data.impl().vx, out);
    count(A::placements);
  }
  what.each([&](A algorithm) {
    if (isKinematic(algorithm) || comesWithOthers(algorithm, what)) return;
    out[algorithm] = runAlgorithm(model, data, algorithm, q, v, a);
    count(algorithm);
  });
  return out;
}

/// Runs one algorithm. The joints and, if the algorithm needs them, the derivatives of their subspaces must have been evaluated at `in`.
AlgorithmViews runEvaluated(A algorithm, const CompactImpl& m, DataImpl& d, const Inputs& in) {
  const kernels::SingleKernels& k = kernels::active().single;
  const auto dynamics = [&](const double* v, const double* a, double* tau) -> AlgorithmViews {
    k.rnea(m, d, v, a, nullptr, tau);
    return {tau};
  };
  switch (algorithm) {
    case A::joint_jacobians:
      k.jointJacobians(m, d, d.J);
      return {d.J};
    case A::rnea:
      return dynamics(in.v, in.a, d.tau);
    case A::nle:
      return dynamics(in.v, d.zero, d.nle);
    case A::gravity:
      return dynamics(d.zero, d.zero, d.g);
    case A::mass_matrix:
      k.massMatrix(m, d, d.M);
      return {d.M};
    case A::rnea_derivatives:
      k.rneaDerivatives(m, d, d.derivatives, in.v, in.a, nullptr, {d.dtau_dq, d.dtau_dv, d.M});
      return {d.dtau_dq, d.dtau_dv, d.M};
    case A::minverse:
      invertTreeInertia("compute", m, d, in.q);
      return {d.Minv};
    case A::coriolis:
      k.coriolis(m, d, d.derivatives, in.v, d.zero);
      k.assemble(m, d.derivatives.by_v, d.C);
      return {d.C};
    case A::centroidal_map:
    case A::centroidal_rate:
      return inOrder(algorithm, centroidalOfEvaluated(m, d, algorithm, in.v, in.a));
    default:
      throw Error(ErrorCode::argument, std::string("compute: ") + info(algorithm).function + " shares no passes with other algorithms");
  }
}

/// Whether the algorithm can run in compute(), which reads q, v and a only.
constexpr bool shares(const AlgorithmInfo& algorithm) {
  return !algorithm.reads('t') && !algorithm.reads('f') && algorithm.algorithm != A::centroidal_derivatives &&
         algorithm.algorithm != A::center_of_mass_jacobian;
}

void checkAll(const CompactModel& model, Data& data, Algorithms what) {
  bool centroidal = false;
  what.each([&](A one) {
    const AlgorithmInfo& algorithm = info(one);
    if (!shares(algorithm))
      throw Error(ErrorCode::argument,
                  std::string("compute: ") + algorithm.function + " is not one of the quantities that it returns; call that function by itself");
    checkData("compute", model, data, algorithm.need);
    centroidal = centroidal || isCentroidal(one);
  });
  if (centroidal && !(model.impl().mass > 0))
    throw Error(ErrorCode::singular, "compute: the model has no mass, so no centre of mass; give its bodies inertias");
}

}  // namespace

AlgorithmViews runAlgorithm(const CompactModel& model, Data& data, Algorithm algorithm, VectorView q, VectorView v, VectorView a) {
  switch (algorithm) {
    case A::placements:
      forwardKinematics(model, data, q, nullptr, nullptr);
      return {};
    case A::velocities:
      forwardKinematics(model, data, q, &v, nullptr);
      return {};
    case A::accelerations:
      forwardKinematics(model, data, q, &v, &a);
      return {};
    case A::joint_jacobians:
      return {jointJacobians(model, data, q)};
    case A::center_of_mass: {
      const CenterOfMass x = centerOfMass(model, data, q, &v, &a);
      DataImpl& d = data.impl();
      d.com = x.position, d.vcom = x.velocity, d.acom = x.acceleration;
      return {&d.com.x, &d.vcom.x, &d.acom.x};
    }
    case A::center_of_mass_jacobian:
      return {jacobianCenterOfMass(model, data, q)};
    case A::energies: {
      DataImpl& d = data.impl();
      d.kinetic = kineticEnergy(model, data, q, v);
      d.potential = sumPotentialEnergy(model.impl(), d);
      return {&d.kinetic, &d.potential};
    }
    case A::rnea:
      return {rnea(model, data, q, v, a, nullptr, 0)};
    case A::nle:
      return {nonLinearEffects(model, data, q, v)};
    case A::gravity:
      return {generalizedGravity(model, data, q)};
    case A::mass_matrix:
      return {crba(model, data, q)};
    case A::aba:
      return {aba(model, data, q, v, a, nullptr, 0)};
    case A::rnea_derivatives: {
      const DerivativeViews x = rneaDerivatives(model, data, q, &v, &a, nullptr, 0);
      return {x.by_q, x.by_v, x.inertia};
    }
    case A::aba_derivatives: {
      const DerivativeViews x = abaDerivatives(model, data, q, v, a, nullptr, 0);
      return {x.by_q, x.by_v, x.inertia, x.ddq};
    }
    case A::minverse:
      return {minverse(model, data, q)};
    case A::coriolis:
      return {coriolisMatrix(model, data, q, v)};
    case A::centroidal_map:
    case A::centroidal_rate:
    case A::centroidal_derivatives:
      return inOrder(algorithm, centroidal(model, data, algorithm, q, v, info(algorithm).reads('a') ? &a : nullptr));
    default:
      throw Error(ErrorCode::argument,
                  std::string(info(algorithm).function) + " is not called by its entry in the catalogue; call the function itself");
  }
}

ComputedViews compute(const CompactModel& model, Data& data, Algorithms what, VectorView q, VectorView v, VectorView a) {
  checkAll(model, data, what);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .a = &a});
  const Inputs in = readInputs("compute", model, data, q, &v, &a);
  if (!m.couplings.empty()) return separately(model, data, what, q, v, a);

  ComputedViews out;
  Passes& passes = out.passes;
  if (what.empty()) return out;
  bool moving = false, varying = false;
  what.each([&](A one) {
    moving = moving || (info(one).reads('v') && one != A::center_of_mass);
    varying = varying || info(one).varies;
  });
  evaluateJoints(m, d, in.q, moving ? in.v : nullptr);
  ++passes.joints;
  if (varying) {
    kernels::active().single.evaluateSubspaces(m, d.derivatives, in.q, in.v);
    ++passes.subspaces;
  }
  const int order = kinematicOrder(what);
  const auto run = [&](A algorithm) {
    out[algorithm] = runEvaluated(algorithm, m, d, in);
    ++countOf(passes, info(algorithm).pass);
  };
  if (has(what, A::joint_jacobians)) run(A::joint_jacobians);  // also places the bodies
  if (order > 0 || (order == 0 && !has(what, A::joint_jacobians))) {
    kernels::active().single.forwardKinematics(m, d, order > 0 ? in.v : nullptr, order > 1 ? in.a : nullptr);
    d.stage = order > 1 ? KinematicsStage::accelerations : order > 0 ? KinematicsStage::velocities : KinematicsStage::poses;
    ++passes.kinematics;
  }
  sums(m, d, what, order, in.v, out);
  what.each([&](A algorithm) {
    if (isKinematic(algorithm) || algorithm == A::joint_jacobians || algorithm == A::gravity) return;
    if (comesWithOthers(algorithm, what)) return;
    run(algorithm);
  });
  if (!has(what, A::gravity)) return out;
  // Gravity comes last, because at rest joints whose subspace varies have another bias.
  bool biased = false;
  for (const TypeBatch& batch : m.batches) biased = biased || batch.shape == Shape::dense;
  if (moving && biased) {
    evaluateJoints(m, d, in.q, d.zero);
    ++passes.joints;
  }
  run(A::gravity);
  return out;
}

}  // namespace dyn::detail
