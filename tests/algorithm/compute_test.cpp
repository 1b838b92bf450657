// SPDX-License-Identifier: BSD-2-Clause
// compute() of several quantities at once gives the results of the single functions, with no more passes than necessary.
#include "data/data_impl.hpp"
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>

using namespace dyn;
using namespace dyn::test;
using Q = Quantity;

namespace {

struct State {
  Eigen::VectorXd q, v, a;
};

State stateOf(const CompactModel& model, std::uint64_t seed) {
  Random random(seed);
  return {integrate(model, neutral(model), random.vector(model.nv(), 0.8)), random.vector(model.nv(), 1), random.vector(model.nv(), 2)};
}

bool near(const Eigen::MatrixXd& x, const Eigen::MatrixXd& expected) {
  return x.rows() == expected.rows() && x.cols() == expected.cols() &&
         (x - expected).cwiseAbs().maxCoeff() <= 1e-12 * std::max(1.0, expected.cwiseAbs().maxCoeff());
}

bool sum(const Passes& p, int joints, int subspaces, int kinematics, int dynamics, int inertias, int derivatives) {
  return p.joints == joints && p.subspaces == subspaces && p.kinematics == kinematics && p.dynamics == dynamics && p.inertias == inertias &&
         p.derivatives == derivatives;
}

}  // namespace

TEST_CASE("everything at once is what each function gives, for all joint types and followers", "[compute]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 5)));
  const bool coupled = seed == 4;
  Model description = randomTree(registry(), coupled ? 22 : 15, seed, true);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  const State s = stateOf(model, seed);
  Quantity all = Q::accelerations | Q::velocities | Q::placements | Q::center_of_mass | Q::energies | Q::rnea | Q::nle | Q::gravity | Q::mass_matrix |
                 Q::minverse | Q::coriolis | Q::centroidal_map | Q::centroidal_rate | Q::rnea_derivatives;
  if (!coupled) all = all | Q::joint_jacobians;
  const Computed x = compute(model, data, all, s.q, s.v, s.a);
  CHECK(near(x.tau, rnea(model, other, s.q, s.v, s.a)));
  CHECK(near(x.nle, nonLinearEffects(model, other, s.q, s.v)));
  CHECK(near(x.gravity, generalizedGravity(model, other, s.q)));
  CHECK(near(x.M, crba(model, other, s.q)));
  CHECK((x.Minv * x.M - Eigen::MatrixXd::Identity(model.nv(), model.nv())).cwiseAbs().maxCoeff() < 1e-8);
  CHECK(near(x.C, computeCoriolisMatrix(model, other, s.q, s.v)));
  const CentroidalRate h = computeCentroidalMomentumTimeVariation(model, other, s.q, s.v, s.a);
  CHECK(near(x.hg, h.hg));
  CHECK(near(x.dhg, h.dhg));
  CHECK(near(x.Ag, h.Ag));
  CHECK(near(x.dAg, h.dAg));
  const RNEADerivatives d = computeRNEADerivatives(model, other, s.q, s.v, s.a);
  CHECK(near(x.dtau_dq, d.dtau_dq));
  CHECK(near(x.dtau_dv, d.dtau_dv));
  CHECK(std::fabs(x.kinetic_energy / computeKineticEnergy(model, other, s.q, s.v) - 1) < 1e-13);
  CHECK(x.potential_energy == Approx(computePotentialEnergy(model, other, s.q)).epsilon(1e-13));
  const CenterOfMass c = centerOfMass(model, other, s.q, s.v, s.a);
  CHECK(near(toEigen(x.center_of_mass.position), toEigen(c.position)));
  CHECK(near(toEigen(x.center_of_mass.acceleration), toEigen(c.acceleration)));
  if (!coupled) CHECK(near(x.J, computeJointJacobians(model, other, s.q)));
}

TEST_CASE("each quantity alone runs its own passes, and leaves the memory of others as it was", "[compute]") {
  const CompactModel model = compile(randomTree(registry(), 15, 2), registry());
  const State s = stateOf(model, 2);
  const double poison = 12345.678;
  const auto run = [&](Quantity what, bool poses, bool velocities, bool forces, bool inertias, bool derivatives) {
    Data data(model, Need::derivatives);
    DataImpl& d = data.impl();
    const int bodies = model.impl().bodies();
    d.oM[1].p.x = d.v[1].linear.x = d.derivatives.vectored->shift_rate[1].a[0] = poison;
    for (int i = 1; i < bodies; ++i) d.f[i].linear.x = d.mass[i] = d.derivatives.bodies.mass[i].x = poison;
    // Tells whether any body's value was changed. Bodies without children may keep the poison.
    const auto handed = [&](auto&& number) {
      int count = 0;
      for (int i = 1; i < bodies; ++i) count += number(i) != poison;
      return count > 0;
    };
    const Passes passes = compute(model, data, what, s.q, s.v, s.a).passes;
    CHECK((d.oM[1].p.x != poison) == poses);
    CHECK((d.v[1].linear.x != poison) == velocities);
    CHECK(handed([&](int i) { return d.f[i].linear.x; }) == forces);
    CHECK((handed([&](int i) { return d.mass[i]; }) || handed([&](int i) { return d.derivatives.bodies.mass[i].x; })) == inertias);
    CHECK((d.derivatives.vectored->shift_rate[1].a[0] != poison) == derivatives);
    return passes;
  };
  CHECK(sum(run(Quantity(), false, false, false, false, false), 0, 0, 0, 0, 0, 0));
  CHECK(sum(run(Q::placements, true, false, false, false, false), 1, 0, 1, 0, 0, 0));
  CHECK(sum(run(Q::center_of_mass, true, false, false, false, false), 1, 0, 1, 0, 0, 0));
  CHECK(sum(run(Q::placements | Q::joint_jacobians, true, false, false, false, false), 1, 0, 1, 0, 0, 0));
  CHECK(sum(run(Q::velocities, true, true, false, false, false), 1, 0, 1, 0, 0, 0));
  CHECK(sum(run(Q::accelerations | Q::energies, true, true, false, false, false), 1, 0, 1, 0, 0, 0));
  CHECK(sum(run(Q::rnea, false, false, true, false, false), 1, 0, 0, 1, 0, 0));
  CHECK(sum(run(Q::gravity, false, false, true, false, false), 1, 0, 0, 1, 0, 0));
  CHECK(sum(run(Q::rnea | Q::nle, false, false, true, false, false), 1, 0, 0, 2, 0, 0));
  CHECK(sum(run(Q::mass_matrix, false, false, false, true, false), 1, 0, 0, 0, 1, 0));
  CHECK(sum(run(Q::minverse, false, false, false, false, false), 1, 0, 0, 0, 1, 0));
  CHECK(sum(run(Q::centroidal_map, false, false, false, true, false), 1, 0, 0, 0, 1, 0));
  CHECK(sum(run(Q::rnea_derivatives | Q::mass_matrix, false, false, false, false, true), 1, 1, 0, 0, 0, 1));
}

TEST_CASE("quantities that data has no room for are refused", "[compute]") {
  const CompactModel model = compile(randomTree(registry(), 5, 2), registry());
  const State s = stateOf(model, 2);
  Data data(model);
  CHECK_NOTHROW(compute(model, data, Q::rnea | Q::placements, s.q, s.v, s.a));
  CHECK_THROWS_WITH(compute(model, data, Q::mass_matrix, s.q, s.v, s.a), containing("Need::mass_matrix"));
  CHECK_THROWS_WITH(compute(model, data, Q::coriolis, s.q, s.v, s.a), containing("Need::derivatives"));
}
