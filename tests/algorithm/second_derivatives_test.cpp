// SPDX-License-Identifier: BSD-2-Clause
// Second derivatives of inverse dynamics compared with differences of first derivatives, for every joint type.
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

/// Central difference of fourth order: df/dt at t = 0 with step h.
template <class F>
Eigen::MatrixXd difference(double h, F&& f) {
  return (8 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}
double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff()); }

}  // namespace

TEST_CASE("second derivatives of rnea are the changes of the first", "[second_derivatives]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 15)));
  const CompactModel model = compile(randomTree(registry(), 8, seed, seed % 2 == 0), registry());
  Data data(model, Need::derivatives);
  SecondDerivativeData second(model);
  Random random(seed);
  // Third derivatives of the pose jump at the knots of spline joints. No knot is within the difference steps around this q.
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.9)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2);
  const RneaSecondDerivatives x = computeRNEASecondOrderDerivatives(model, data, second, q, v, a);
  const double h = 1e-4;
  for (int k = 0; k < model.nv(); ++k) {
    const Eigen::VectorXd e = Eigen::VectorXd::Unit(model.nv(), k);
    const auto moved = [&](double t) { return integrate(model, q, Eigen::VectorXd(t * e)); };
    INFO("direction " << k << " of joint type " << model.joints()[static_cast<std::size_t>(1 + std::min(k, model.njoints() - 2))].type);
    CHECK(distance(x.d2tau_dqdq[k],
                   difference(h, [&](double t) { return Eigen::MatrixXd(computeRNEADerivatives(model, data, moved(t), v, a).dtau_dq); })) < 1e-7);
    CHECK(distance(x.d2tau_dqdv[k],
                   difference(h, [&](double t) { return Eigen::MatrixXd(computeRNEADerivatives(model, data, moved(t), v, a).dtau_dv); })) < 1e-7);
    CHECK(distance(x.d2tau_dadq[k], difference(h, [&](double t) { return Eigen::MatrixXd(crba(model, data, moved(t))); })) < 1e-8);
    // Friction jumps where a velocity changes sign. Neither d2tau_dvdv nor a difference of first derivatives contains this jump.
    CHECK(distance(x.d2tau_dvdv[k],
                   difference(h, [&](double t) { return Eigen::MatrixXd(computeRNEADerivatives(model, data, q, v + t * e, a).dtau_dv); })) < 1e-9);
  }
  for (int k = 0; k < model.nv(); ++k)
    for (int j = 0; j < k; ++j) CHECK(distance(x.d2tau_dvdv[k].col(j), x.d2tau_dvdv[j].col(k)) < 1e-12);
}

TEST_CASE("second derivatives of a flat chain are symmetric, and memory is theirs alone", "[second_derivatives]") {
  const CompactModel model = compile(treeOf(registry(), {"revolute", "prismatic"}, 6, 3), registry());
  Data data(model, Need::derivatives);
  SecondDerivativeData second(model);
  Random random(2);
  const Eigen::VectorXd q = random.vector(6, 1), v = random.vector(6, 1), a = random.vector(6, 1);
  const Eigen::MatrixXd before = computeRNEADerivatives(model, data, q, v, a).dtau_dq;
  const RneaSecondDerivatives x = computeRNEASecondOrderDerivatives(model, data, second, q, v, a);
  for (int k = 0; k < 6; ++k)
    for (int j = 0; j < k; ++j) CHECK(distance(x.d2tau_dqdq[k].col(j), x.d2tau_dqdq[j].col(k)) < 1e-12);
  CHECK(distance(computeRNEADerivatives(model, data, q, v, a).dtau_dq, before) == 0);

  Model coupled = randomTree(registry(), 20, 5);
  addDependent(coupled);
  const CompactModel dependents = compile(coupled, registry());
  Data others(dependents, Need::derivatives);
  SecondDerivativeData theirs(dependents);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(dependents.nv());
  CHECK_THROWS_WITH(computeRNEASecondOrderDerivatives(dependents, others, theirs, neutral(dependents), zero, zero), containing("follow others"));
  CHECK_THROWS_WITH(computeRNEASecondOrderDerivatives(model, data, theirs, q, v, a), containing("another model"));
}
