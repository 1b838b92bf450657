// SPDX-License-Identifier: BSD-2-Clause
// Checks the joint in a mechanism: between two revolute joints the algorithms must agree with each other and with the energy balance.
#include "conformance/checks.hpp"

#include <dyn/dyn.hpp>

namespace dyn::conformance {

namespace {

Mat3<double> rotationAbout(const Vec3<double>& n, double angle) {
  const Mat3<double> K = skew(n);
  return Mat3<double>::identity() + std::sin(angle) * K + (1 - std::cos(angle)) * (K * K);
}

SE3<double> randomPlacement(Random& random) {
  const Vec3<double> n = random.direction();
  return {rotationAbout(n, random.uniform(-3, 3)), {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)}};
}

/// Inertia of a ball with three point masses. It is positive definite and satisfies the triangle inequalities.
Inertia<double> randomInertia(Random& random) {
  Inertia<double> Y{
      random.uniform(1, 3), {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2)}, {0.02, 0, 0, 0.02, 0, 0.02}};
  for (int i = 0; i < 3; ++i) Y.rotational = Y.rotational + random.uniform(0.01, 0.1) * pointInertia(random.direction());
  return Y;
}

JointDescription revolute(const char* name, Random& random) {
  JointDescription joint;
  joint.name = name;
  joint.type = "revolute";
  const Vec3<double> n = random.direction();
  joint.parameters["axis"] = std::vector<double>{n.x, n.y, n.z};
  joint.placement = randomPlacement(random);
  return joint;
}

CompactModel sandwich(const JointType& type, const Parameters& parameters, const JointRegistry& registry, Random& random) {
  Model model;
  model.name = "conformance";
  const int first = model.addBody("first", 0, revolute("before", random), randomInertia(random));
  JointDescription joint;
  joint.name = "joint";
  joint.type = type.info().name;
  joint.parameters = parameters;
  joint.placement = randomPlacement(random);
  const int second = model.addBody("second", first, joint, randomInertia(random));
  model.addBody("third", second, revolute("after", random), randomInertia(random));
  return compile(model, registry);
}

/// Returns the registry with the type added, unless it has the type already.
JointRegistry including(const JointType& type, const JointRegistry& registry) {
  JointRegistry extended = registry;
  for (const JointType* known : registry.jointTypes())
    if (known == &type) return extended;
  extended.add(type);
  return extended;
}

struct State {
  Eigen::VectorXd q, v, a;
  std::string where() const { return show("q", q) + ", " + show("v", v); }
};

void checkInverse(const CompactModel& model, Data& data, const State& s, Worst& worst) {
  const Eigen::VectorXd tau = s.a;  // any torques will do
  const Eigen::VectorXd a = aba(model, data, s.q, s.v, tau), back = rnea(model, data, s.q, s.v, a);
  // Near a singular configuration accelerations are large, and so are the terms that cancel in rnea.
  const Eigen::MatrixXd M = crba(model, data, s.q);
  const double terms = std::max(1.0, (M.cwiseAbs() * a.cwiseAbs()).maxCoeff());
  worst.add((back - tau).allFinite() ? (back - tau).cwiseAbs().maxCoeff() / terms : std::numeric_limits<double>::infinity(), s.where());
}

void checkMassMatrix(const CompactModel& model, Data& data, const State& s, Worst& worst) {
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(model.nv()), gravity = rnea(model, data, s.q, still, still);
  const Eigen::MatrixXd M = crba(model, data, s.q);
  Eigen::MatrixXd columns(model.nv(), model.nv());
  for (int k = 0; k < model.nv(); ++k)
    columns.col(k) = rnea(model, data, s.q, still, Eigen::VectorXd(Eigen::VectorXd::Unit(model.nv(), k))) - gravity;
  worst.compare(M, columns, show("q", s.q));
}

/// Checks dtau/dq and dtau/dv of rnea, which contain the derivatives of S and its bias, against differences.
void checkDerivatives(const CompactModel& model, Data& data, const State& s, Worst& by_q, Worst& by_v) {
  const auto& found = computeRNEADerivatives(model, data, s.q, s.v, s.a);
  const Eigen::MatrixXd dtau_dq = found.dtau_dq, dtau_dv = found.dtau_dv;
  for (int k = 0; k < model.nv(); ++k) {
    const Eigen::VectorXd unit = Eigen::VectorXd::Unit(model.nv(), k);
    const Eigen::VectorXd along_q =
        derivativeAtZero([&](double h) { return Eigen::VectorXd(rnea(model, data, integrate(model, s.q, Eigen::VectorXd(h * unit)), s.v, s.a)); });
    const Eigen::VectorXd along_v =
        derivativeAtZero([&](double h) { return Eigen::VectorXd(rnea(model, data, s.q, Eigen::VectorXd(s.v + h * unit), s.a)); });
    by_q.compare(dtau_dq.col(k), along_q, s.where());
    by_v.compare(dtau_dv.col(k), along_v, s.where());
  }
}

/// Checks that dE/dt = v . tau along a motion that starts with v and a.
void checkEnergy(const CompactModel& model, Data& data, const State& s, Worst& worst) {
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  const Eigen::VectorXd rate = derivativeAtZero([&](double h) {
    const Eigen::VectorXd q = integrate(model, s.q, Eigen::VectorXd(h * s.v + h * h / 2 * s.a)), v = s.v + h * s.a;
    return Eigen::VectorXd(Eigen::VectorXd::Constant(1, computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q)));
  });
  const double terms = std::max(1.0, (s.v.cwiseAbs().array() * tau.cwiseAbs().array()).maxCoeff());
  worst.add(std::fabs(rate[0] - s.v.dot(tau)) / terms, s.where());
}

}  // namespace

void checkDynamics(const JointType& type, const Parameters& parameters, const JointRegistry& registry, std::uint64_t seed, Findings& findings) {
  Random random(seed);
  Worst inverse("dynamics: rnea undoes aba", 1e-9), mass("dynamics: columns of M are differences of rnea", 1e-10);
  Worst energy("dynamics: dE/dt = v . tau", 1e-8);
  Worst by_q("dynamics: derivatives of rnea by q (differences)", 1e-8), by_v("dynamics: derivatives of rnea by v (differences)", 1e-8);
  const JointRegistry extended = including(type, registry);
  for (int i = 0; i < 3; ++i) {
    const CompactModel model = sandwich(type, parameters, extended, random);
    Data data(model, Need::mass_matrix | Need::derivatives);
    const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1.2));
    const State s{q, random.vector(model.nv(), 1), random.vector(model.nv(), 1)};
    checkInverse(model, data, s, inverse);
    checkMassMatrix(model, data, s, mass);
    checkEnergy(model, data, s, energy);
    checkDerivatives(model, data, s, by_q, by_v);
  }
  inverse.into(findings);
  mass.into(findings);
  energy.into(findings);
  by_q.into(findings);
  by_v.into(findings);
}

}  // namespace dyn::conformance
