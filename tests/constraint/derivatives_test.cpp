// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of constrained dynamics and of impacts compared with differences of fourth order.
#include "constraint/support.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

/// Derivative of f(moved(e)) by e in R^n at e = 0, by central differences of fourth order with step h.
template <class F, class Moved>
Eigen::MatrixXd differences(Eigen::Index n, double h, Moved&& moved, F&& f) {
  Eigen::MatrixXd out;
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto at = [&](double t) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(n);
      step[k] = t;
      return Eigen::VectorXd(f(moved(step)));
    };
    const Eigen::VectorXd column = (8 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h);
    if (k == 0) out.resize(column.size(), n);
    out.col(k) = column;
  }
  return out;
}

/// Differences of f(q, v) along the tangent directions of q and by v.
struct StateDifferences {
  Eigen::MatrixXd by_q, by_v;
};
template <class F>
StateDifferences stateDifferences(const CompactModel& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v, F&& f) {
  constexpr double h = 1e-3;
  const auto turned = [&](const Eigen::VectorXd& e) { return integrate(model, q, e); };
  const auto faster = [&](const Eigen::VectorXd& e) { return Eigen::VectorXd(v + e); };
  return {differences(model.nv(), h, turned, [&](const Eigen::VectorXd& moved) { return f(moved, v); }),
          differences(model.nv(), h, faster, [&](const Eigen::VectorXd& moved) { return f(q, moved); })};
}

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff()); }

/// Gives some of the constraints a target that they are away from, and all of them feedback. Fixes all rotations where two are free.
void addTargets(Subject& s, std::uint64_t seed) {
  Random random(seed);
  Data data(s.model);
  forwardKinematics(s.model, data, s.q);
  for (ConstraintDescription& d : s.constraints) {
    auto& c = std::get<FrameConstraint>(d.relation);
    d.baumgarte.velocity = 3;
    if (std::count(c.free.begin() + 3, c.free.end(), true) == 2) c.free[3] = c.free[4] = c.free[5] = false;
    if (random.below(3) == 0 || (c.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED && (c.free[3] || c.free[4] || c.free[5]))) continue;
    c.has_target = true;
    d.baumgarte.position = 20;
    const SE3<double> first = framePlacement(s.model, data, s.model.frameId(c.frame)),
                      second = framePlacement(s.model, data, s.model.frameId(c.other));
    c.other_placement = second.inverse() * first * SE3<double>{exp3(random.vector(0.3)), random.vector(0.2)};
  }
}

/// Tells whether the rows are independent and the results moderate, so that differences can be compared with derivatives.
bool wellPosed(const ConstrainedMotion& x, const ConstraintSet& set) {
  return x.rank == set.rows() && x.lambda.cwiseAbs().maxCoeff() < 1e4 && x.ddq.cwiseAbs().maxCoeff() < 1e4;
}

}  // namespace

TEST_CASE("derivatives of constrained dynamics are those of differences", "[constraint]") {
  int judged = 0;
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    CAPTURE(seed);
    Subject s = randomScene(seed, 9, 1 + static_cast<int>(seed % 2));
    addTargets(s, seed);
    if (seed % 5 == 0) {
      ConstraintDescription lock = lockJoint(s.model.joints()[3].name);
      lock.baumgarte = {seed % 10 == 0 ? 9.0 : 0.0, 2};
      const JointRecord& j = s.model.joints()[3];
      if (seed % 10 == 0) {
        const Eigen::VectorXd at = integrate(s.model, s.q, Eigen::VectorXd::Constant(s.model.nv(), 0.1)).segment(j.idx_q, j.nq);
        std::get<JointLock>(lock.relation).configuration.assign(at.data(), at.data() + at.size());
      }
      s.constraints.push_back(lock);
    }
    Data data(s.model, Need::derivatives);
    ConstraintData c(ConstraintSet(s.model, s.constraints), Need::derivatives);
    if (!wellPosed(constraintDynamics(s.model, data, s.q, s.v, s.tau, c), c.set())) continue;
    ++judged;
    const ConstraintDynamicsDerivatives x = computeConstraintDynamicsDerivatives(s.model, data, s.q, s.v, s.tau, c);
    const Eigen::MatrixXd ddq_dq = x.ddq_dq, ddq_dv = x.ddq_dv, ddq_dtau = x.ddq_dtau, lambda_dq = x.lambda_dq, lambda_dv = x.lambda_dv,
                          lambda_dtau = x.lambda_dtau;
    const Eigen::Index n = s.model.nv(), rows = c.set().rows();
    const auto both = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& tau) {
      const ConstrainedMotion y = constraintDynamics(s.model, data, q, v, tau, c);
      Eigen::VectorXd out(n + rows);
      out << y.ddq, y.lambda;
      return out;
    };
    const double h = 1e-3;
    const auto [by_q, by_v] =
        stateDifferences(s.model, s.q, s.v, [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) { return both(q, v, s.tau); });
    const Eigen::MatrixXd by_tau = differences(
        n, h, [&](const Eigen::VectorXd& e) { return Eigen::VectorXd(s.tau + e); }, [&](const Eigen::VectorXd& tau) { return both(s.q, s.v, tau); });
    CHECK(distance(ddq_dq, by_q.topRows(n)) < 1e-6);
    CHECK(distance(lambda_dq, by_q.bottomRows(rows)) < 1e-6);
    CHECK(distance(ddq_dv, by_v.topRows(n)) < 1e-7);
    CHECK(distance(lambda_dv, by_v.bottomRows(rows)) < 1e-7);
    CHECK(distance(ddq_dtau, by_tau.topRows(n)) < 1e-8);
    CHECK(distance(lambda_dtau, by_tau.bottomRows(rows)) < 1e-8);
  }
  CHECK(judged >= 12);
}

TEST_CASE("constraints that repeat each other do not change the derivatives of accelerations", "[constraint]") {
  int judged = 0;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    CAPTURE(seed);
    Subject s = randomScene(seed, 9, 1);
    Data data(s.model, Need::derivatives);
    ConstraintData once(ConstraintSet(s.model, s.constraints), Need::derivatives);
    if (!wellPosed(constraintDynamics(s.model, data, s.q, s.v, s.tau, once), once.set())) continue;
    ++judged;
    const ConstraintDynamicsDerivatives x = computeConstraintDynamicsDerivatives(s.model, data, s.q, s.v, s.tau, once);
    const Eigen::MatrixXd by_q = x.ddq_dq, by_v = x.ddq_dv, by_tau = x.ddq_dtau;
    for (std::size_t k = s.constraints.size(); k-- > 0;) {
      s.constraints.push_back(s.constraints[k]);
      s.constraints.back().name += " again";
    }
    ConstraintData twice(ConstraintSet(s.model, s.constraints), Need::derivatives);
    for (const double mu : {0.0, 1e-6}) {
      CAPTURE(mu);
      twice.settings.mu = mu;
      const ConstraintDynamicsDerivatives y = computeConstraintDynamicsDerivatives(s.model, data, s.q, s.v, s.tau, twice);
      CHECK(distance(y.ddq_dq, by_q) < 1e-8);
      CHECK(distance(y.ddq_dv, by_v) < 1e-8);
      CHECK(distance(y.ddq_dtau, by_tau) < 1e-8);
      CHECK(y.lambda_dq.allFinite());
    }
  }
  CHECK(judged >= 9);
}

TEST_CASE("derivatives of couplings kept by forces are those of differences", "[constraint]") {
  const Model description = randomTree(registry(), 8, 5);
  std::vector<std::string> single;
  const CompactModel model = compile(description, registry());
  for (const JointRecord& j : model.joints())
    if (j.nv == 1 && j.nq == 1) single.push_back(j.name);
  REQUIRE(single.size() >= 2);
  ConstraintDescription gear = coupleJoint(single[0], {"mimic", single[1], {{"coefficients", std::vector<double>{0.1, 0.7, -0.4, 0.3}}}});
  gear.baumgarte = {7, 3};
  Random random(8);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1)), v = random.vector(model.nv(), 1),
                        tau = random.vector(model.nv(), 5);
  Data data(model, Need::derivatives);
  ConstraintData c(ConstraintSet(model, {gear, pointContact("tool")}, &registry()), Need::derivatives);
  const ConstraintDynamicsDerivatives x = computeConstraintDynamicsDerivatives(model, data, q, v, tau, c);
  const Eigen::MatrixXd ddq_dq = x.ddq_dq, ddq_dv = x.ddq_dv, lambda_dq = x.lambda_dq;
  const auto at = [&](const Eigen::VectorXd& q1, const Eigen::VectorXd& v1) {
    const ConstrainedMotion y = constraintDynamics(model, data, q1, v1, tau, c);
    Eigen::VectorXd out(model.nv() + 4);
    out << y.ddq, y.lambda;
    return out;
  };
  const auto [by_q, by_v] = stateDifferences(model, q, v, at);
  CHECK(distance(ddq_dq, by_q.topRows(model.nv())) < 1e-6);
  CHECK(distance(lambda_dq, by_q.bottomRows(4)) < 1e-6);
  CHECK(distance(ddq_dv, by_v.topRows(model.nv())) < 1e-7);
}

TEST_CASE("derivatives of impacts are those of differences", "[constraint]") {
  int judged = 0;
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    CAPTURE(seed);
    const Subject s = randomScene(seed, 9, 1 + static_cast<int>(seed % 2));
    Data data(s.model, Need::derivatives);
    ConstraintData c(ConstraintSet(s.model, s.constraints), Need::derivatives);
    if (!wellPosed(constraintDynamics(s.model, data, s.q, s.v, s.tau, c), c.set())) continue;
    ++judged;
    const double restitution = 0.3;
    const ImpulseDynamicsDerivatives x = computeImpulseDynamicsDerivatives(s.model, data, s.q, s.v, restitution, c);
    const Eigen::MatrixXd v_dq = x.v_after_dq, v_dv = x.v_after_dv, impulse_dq = x.impulse_dq, impulse_dv = x.impulse_dv;
    const Eigen::Index n = s.model.nv(), rows = c.set().rows();
    const auto both = [&](const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
      const ConstrainedImpact y = impulseDynamics(s.model, data, q, v, restitution, c);
      Eigen::VectorXd out(n + rows);
      out << y.v_after, y.impulse;
      return out;
    };
    const auto [by_q, by_v] = stateDifferences(s.model, s.q, s.v, both);
    CHECK(distance(v_dq, by_q.topRows(n)) < 1e-6);
    CHECK(distance(impulse_dq, by_q.bottomRows(rows)) < 1e-6);
    CHECK(distance(v_dv, by_v.topRows(n)) < 1e-8);
    CHECK(distance(impulse_dv, by_v.bottomRows(rows)) < 1e-8);
  }
  CHECK(judged >= 7);
}
