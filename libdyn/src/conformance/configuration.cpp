// SPDX-License-Identifier: BSD-2-Clause
// Checks a joint's configuration space: integrate and difference are inverses, their Jacobians are derivatives, normalize keeps normalised q.
#include "conformance/checks.hpp"

namespace dyn::conformance {

namespace {

Eigen::MatrixXd flatten(const SE3<double>& X) {
  Eigen::MatrixXd out(3, 4);
  for (int i = 0; i < 3; ++i) out.row(i) << X.R(i, 0), X.R(i, 1), X.R(i, 2), X.p[i];
  return out;
}

/// Column k is the derivative of f(h e_k) at h = 0.
template <class F>
Eigen::MatrixXd jacobianByDifferences(int nv, const F& f) {
  Eigen::MatrixXd J(nv, nv);
  for (int k = 0; k < nv; ++k) J.col(k) = derivativeAtZero([&](double h) { return f(Eigen::VectorXd(h * Eigen::VectorXd::Unit(nv, k))); });
  return J;
}

void checkRoundTrips(const JointProbe& joint, Random& random, Findings& findings) {
  const Eigen::VectorXd still = Eigen::VectorXd::Zero(joint.nv());
  Worst stay("q (+) 0 = q", 1e-14), self("q (-) q = 0", 1e-14), there("(q (+) v) (-) q = v", 1e-12);
  Worst back("q0 (+) (q1 (-) q0) is the pose of q1", 1e-12);
  for (int i = 0; i < sample_count; ++i) {
    const Eigen::VectorXd q0 = randomConfiguration(joint, random), q1 = randomConfiguration(joint, random);
    // Rotations stay below pi; beyond that difference() returns another vector.
    const Eigen::VectorXd v = random.vector(joint.nv(), 1.2);
    stay.compare(joint.integrate(q0, still), q0, show("q", q0));
    self.compare(joint.difference(q0, q0), still, show("q", q0));
    there.compare(joint.difference(q0, joint.integrate(q0, v)), v, show("q", q0) + ", " + show("v", v));
    back.compare(flatten(joint.pose(joint.integrate(q0, joint.difference(q0, q1)))), flatten(joint.pose(q1)), show("q0", q0) + ", " + show("q1", q1));
  }
  stay.into(findings);
  self.into(findings);
  there.into(findings);
  back.into(findings);
  if (!joint.flat()) return;
  Worst sum("q (+) v = q + v, as v = dq/dt", 1e-14);
  for (int i = 0; i < sample_count; ++i) {
    const Eigen::VectorXd q = randomConfiguration(joint, random), v = random.vector(joint.nv(), 1.2);
    sum.compare(joint.integrate(q, v), q + v, show("q", q) + ", " + show("v", v));
  }
  sum.into(findings);
}

void checkJacobians(const JointProbe& joint, Random& random, Findings& findings) {
  const int nv = joint.nv();
  Worst integrate_q("dIntegrate by q", 1e-8), integrate_v("dIntegrate by v", 1e-8);
  Worst difference_0("dDifference by q0", 1e-8), difference_1("dDifference by q1", 1e-8);
  for (int i = 0; i < sample_count; ++i) {
    const Eigen::VectorXd q = randomConfiguration(joint, random), v = random.vector(nv, 1.2), end = joint.integrate(q, v);
    const std::string where = show("q", q) + ", " + show("v", v);
    const JointProbe::Jacobians I = joint.dIntegrate(q, v), D = joint.dDifference(q, end);
    const auto from_end = [&](const Eigen::VectorXd& x) { return joint.difference(end, x); };
    integrate_q.compare(
        I.first, jacobianByDifferences(nv, [&](const Eigen::VectorXd& d) { return from_end(joint.integrate(joint.integrate(q, d), v)); }), where);
    integrate_v.compare(I.second, jacobianByDifferences(nv, [&](const Eigen::VectorXd& d) { return from_end(joint.integrate(q, v + d)); }), where);
    difference_0.compare(D.first, jacobianByDifferences(nv, [&](const Eigen::VectorXd& d) { return joint.difference(joint.integrate(q, d), end); }),
                         where);
    difference_1.compare(D.second, jacobianByDifferences(nv, [&](const Eigen::VectorXd& d) { return joint.difference(q, joint.integrate(end, d)); }),
                         where);
  }
  for (Worst* w : {&integrate_q, &integrate_v, &difference_0, &difference_1}) w->into(findings);
}

void checkNormalize(const JointProbe& joint, Random& random, Findings& findings) {
  Worst neutral("neutral is normalised", 1e-15), fixed("normalize leaves normalised q alone", 1e-15),
      again("normalize twice is normalize once", 1e-15);
  double distance = 0;
  const Eigen::VectorXd zero = joint.neutral();
  neutral.compare(joint.normalize(zero, distance), zero, show("q", zero));
  neutral.add(std::fabs(distance), "the distance it returns");
  for (int i = 0; i < sample_count; ++i) {
    const Eigen::VectorXd q = randomConfiguration(joint, random);
    // integrate() made q, so two roundings are allowed for: of the sum of squares and of the quotient.
    fixed.add((joint.normalize(q, distance) - q).cwiseAbs().maxCoeff() / 4, show("q", q));
    fixed.add(std::fabs(distance) / 4, show("q", q));
    const Eigen::VectorXd off = q + random.vector(joint.nq(), 0.3), once = joint.normalize(off, distance);
    if (!(distance >= 0)) again.add(std::numeric_limits<double>::infinity(), "the distance returned for " + show("q", off));
    again.compare(joint.normalize(once, distance), once, show("q", off));
    again.add(std::fabs(distance) / 4, show("q", off));
  }
  neutral.into(findings);
  fixed.into(findings);
  again.into(findings);
}

}  // namespace

Eigen::VectorXd randomConfiguration(const JointProbe& joint, Random& random) {
  return joint.integrate(joint.neutral(), random.vector(joint.nv(), 1.4));
}

void checkConfiguration(const JointProbe& joint, std::uint64_t seed, Findings& findings) {
  if (joint.nv() == 0) return;
  Random random(seed);
  checkRoundTrips(joint, random, findings);
  checkJacobians(joint, random, findings);
  checkNormalize(joint, random, findings);
}

}  // namespace dyn::conformance
