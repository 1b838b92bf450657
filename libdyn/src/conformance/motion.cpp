// SPDX-License-Identifier: BSD-2-Clause
// Checks a joint's motion subspace and bias against its pose map.
#include "conformance/checks.hpp"

#include <Eigen/SVD>

namespace dyn::conformance {

namespace {

using Column = Eigen::Matrix<double, 6, 1>;

Column toVector(const Motion<double>& m) {
  Column x;
  x << m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z;
  return x;
}

Eigen::MatrixXd subspaceOf(const JointMotion<double>& motion, int nv) {
  Eigen::MatrixXd S(6, nv);
  for (int k = 0; k < nv; ++k) S.col(k) = toVector(motion.columns[k]);
  return S;
}

/// The largest of |R^T R - 1|, entry by entry, and |det R - 1|. Infinite if R is not finite.
double distanceFromRotation(const Mat3<double>& R) {
  const Mat3<double> E = transpose(R) * R - Mat3<double>::identity();
  double worst = std::fabs(dot(R.col(0), cross(R.col(1), R.col(2))) - 1);
  for (const double e : E.m) worst = std::isfinite(e) ? std::max(worst, std::fabs(e)) : std::numeric_limits<double>::infinity();
  return worst;
}

double distanceFromPose(const SE3<double>& X) {
  const bool finite = std::isfinite(X.p.x) && std::isfinite(X.p.y) && std::isfinite(X.p.z);
  return finite ? distanceFromRotation(X.R) : std::numeric_limits<double>::infinity();
}

/// Velocity of the pose in the moving frame at h = 0 along a curve of configurations, by finite differences.
template <class Curve>
Column velocityAlong(const JointProbe& joint, const Curve& curve) {
  const SE3<double> X0 = joint.pose(curve(0.0));
  return derivativeAtZero([&](double h) {
    const SE3<double> X = joint.pose(curve(h));
    return Eigen::VectorXd(toVector({transposeTimes(X0.R, X.p - X0.p), vee(transpose(X0.R) * X.R)}));
  });
}

void checkPose(const JointProbe& joint, const std::vector<Eigen::VectorXd>& samples, Findings& findings) {
  Worst pose("pose is in SE(3)", 1e-13), frames("constant parts of the motion are in SE(3)", 1e-14);
  for (const Eigen::VectorXd& q : samples) pose.add(distanceFromPose(joint.pose(q)), show("q", q));
  frames.add(distanceFromPose(joint.instance().before), "before");
  frames.add(distanceFromPose(joint.instance().after), "after");
  pose.into(findings);
  frames.into(findings);
}

void checkSubspace(const JointProbe& joint, const std::vector<Eigen::VectorXd>& samples, Findings& findings) {
  Worst check("subspace: S is the velocity of the pose (differences)", 1e-8);
  for (const Eigen::VectorXd& q : samples) {
    const Eigen::MatrixXd S = subspaceOf(joint.motion(q), joint.nv());
    for (int k = 0; k < joint.nv(); ++k) {
      const auto curve = [&](double h) { return joint.integrate(q, Eigen::VectorXd(h * Eigen::VectorXd::Unit(joint.nv(), k))); };
      check.compare(velocityAlong(joint, curve), S.col(k), "column " + std::to_string(k) + " at " + show("q", q));
    }
  }
  check.into(findings);
}

/// The configuration as dual numbers with the derivative `direction`.
std::vector<Dual<double>> dualOf(const Eigen::VectorXd& q, const Eigen::VectorXd& direction) {
  std::vector<Dual<double>> x;
  for (Eigen::Index i = 0; i < q.size(); ++i) x.emplace_back(q[i], direction[i]);
  return x;
}

/// Needs dq/dt. The kinematics call with dual numbers then differentiates exactly.
void checkDual(const JointProbe& joint, const std::vector<Eigen::VectorXd>& samples, Findings& findings) {
  Worst check("subspace: S is the velocity of the pose (duals)", 1e-12), value("kinematics with duals has the same values", 1e-14);
  for (const Eigen::VectorXd& q : samples) {
    const JointMotion<double> plain = joint.motion(q);
    const Eigen::MatrixXd S = subspaceOf(plain, joint.nv());
    for (int k = 0; k < joint.nv(); ++k) {
      const std::vector<Dual<double>> qd = dualOf(q, joint.rates(q, Eigen::VectorXd::Unit(joint.nv(), k)));
      const SE3<Dual<double>> X = joint.motion<Dual<double>>(qd.data(), nullptr).pose;
      Mat3<double> R, dR;
      for (int i = 0; i < 9; ++i) {
        R.m[i] = X.R.m[i].v;
        dR.m[i] = X.R.m[i].d;
        value.compare(Eigen::VectorXd::Constant(1, R.m[i]), Eigen::VectorXd::Constant(1, plain.pose.R.m[i]), show("q", q));
      }
      const Motion<double> velocity{transposeTimes(R, Vec3<double>{X.p.x.d, X.p.y.d, X.p.z.d}), vee(transpose(R) * dR)};
      check.compare(toVector(velocity), S.col(k), "column " + std::to_string(k) + " at " + show("q", q));
    }
  }
  check.into(findings);
  value.into(findings);
}

/// Checks the bias against (dS/dt) v from dual numbers of S along dq/dt = rates(q, v).
void checkBias(const JointProbe& joint, const std::vector<Eigen::VectorXd>& samples, Random& random, Findings& findings) {
  Worst check("bias is (dS/dt) v", 1e-12);
  for (const Eigen::VectorXd& q : samples) {
    const Eigen::VectorXd v = random.vector(joint.nv(), 2);
    const std::vector<Dual<double>> qd = dualOf(q, joint.rates(q, v)), vd = dualOf(v, Eigen::VectorXd::Zero(joint.nv()));
    const JointMotion<Dual<double>> moving = joint.motion(qd.data(), vd.data());
    Column expected = Column::Zero();
    for (int k = 0; k < joint.nv(); ++k)
      for (int i = 0; i < 3; ++i) {
        expected[i] += moving.columns[k].linear[i].d * v[k];
        expected[3 + i] += moving.columns[k].angular[i].d * v[k];
      }
    check.compare(toVector(joint.motion(q.data(), v.data()).bias), expected, show("q", q) + ", " + show("v", v));
  }
  check.into(findings);
}

/// Coordinates far beyond those of any robot must still give poses in SE(3), and NaN must not become infinity.
void checkRange(const JointProbe& joint, Random& random, Findings& findings) {
  Worst far("poses of q up to 1e6 are in SE(3)", 1e-12), nan("NaN in q gives NaN or finite numbers", 0);
  for (const double size : {1e3, 1e6})
    for (int sign : {-1, 1}) {
      const Eigen::VectorXd all = Eigen::VectorXd::Constant(joint.nq(), sign * size), some = random.vector(joint.nq(), size);
      far.add(distanceFromPose(joint.pose(all)), show("q", all));
      far.add(distanceFromPose(joint.pose(some)), show("q", some));
    }
  for (int k = 0; k < joint.nq(); ++k) {
    Eigen::VectorXd q = joint.neutral();
    q[k] = std::numeric_limits<double>::quiet_NaN();
    const JointMotion<double> motion = joint.motion(q);
    bool infinite = false;
    for (const double e : motion.pose.R.m) infinite = infinite || std::isinf(e);
    for (int i = 0; i < 3; ++i) infinite = infinite || std::isinf(motion.pose.p[i]);
    nan.add(infinite ? 1 : 0, "q[" + std::to_string(k) + "] = NaN");
  }
  far.into(findings);
  nan.into(findings);
}

constexpr double jump = 1e-6;  // a change of S between neighbouring configurations; a smooth S changes by less

/// Compares S at neutral with S on either side. At a kink S differs between the sides, and may have a third value at the kink itself.
void checkNeutral(const JointProbe& joint, Findings& findings) {
  Worst check("subspace: S at neutral is S on either side of it", jump);
  const Eigen::MatrixXd S = subspaceOf(joint.motion(joint.neutral()), joint.nv());
  for (int k = 0; k < joint.nv(); ++k)
    for (const double h : {-1e-9, 1e-9}) {
      const Eigen::VectorXd q = joint.integrate(joint.neutral(), Eigen::VectorXd(h * Eigen::VectorXd::Unit(joint.nv(), k)));
      check.compare(subspaceOf(joint.motion(q), joint.nv()), S, show("q", q));
    }
  check.into(findings);
}

/// Samples next to a jump of S do not show it, so bisection along lines through neutral finds it. A jump is reported as information, since a rail of
/// lines and arcs has jumps. A column that becomes zero at once is a failure, since the pose is clamped there.
void checkClamps(const JointProbe& joint, Random& random, Findings& findings) {
  constexpr int lines = 4, steps = 48, halvings = 32;
  constexpr double reach = 3;
  Worst clamps("subspace: S does not break off to zero", 0);
  std::string jumps;
  for (int line = 0; line < lines; ++line) {
    const Eigen::VectorXd direction = random.vector(joint.nv(), 1);
    const auto at = [&](double t) { return joint.integrate(joint.neutral(), Eigen::VectorXd(t * direction)); };
    const auto subspace = [&](double t) { return subspaceOf(joint.motion(at(t)), joint.nv()); };
    for (int step = 0; step < steps; ++step) {
      double low = -reach + 2 * reach * step / steps, high = -reach + 2 * reach * (step + 1) / steps;
      Eigen::MatrixXd below = subspace(low), above = subspace(high);
      for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (low + high);
        const Eigen::MatrixXd S = subspace(middle);
        const bool first = (S - below).cwiseAbs().maxCoeff() > (above - S).cwiseAbs().maxCoeff();
        (first ? high : low) = middle;
        (first ? above : below) = S;
      }
      if ((above - below).cwiseAbs().maxCoeff() <= jump * std::max(1.0, below.cwiseAbs().maxCoeff())) continue;
      jumps = "at " + show("q", at(high));
      for (int k = 0; k < joint.nv(); ++k)
        if (below.col(k).isZero(0) != above.col(k).isZero(0)) clamps.add(1, "column " + std::to_string(k) + " at " + show("q", at(high)));
    }
  }
  clamps.into(findings);
  if (!jumps.empty()) findings.push_back({"information: S jumps", true, 0, 0, jumps});
}

/// Reports the rank of S as information. It is never a failure: many joints have singular configurations.
void reportRank(const JointProbe& joint, const Eigen::VectorXd& q, Findings& findings) {
  const auto rank = [&](const Eigen::VectorXd& at) {
    const Eigen::MatrixXd S = subspaceOf(joint.motion(at), joint.nv());
    if (S.size() == 0 || !S.allFinite()) return Eigen::Index(0);
    Eigen::JacobiSVD<Eigen::MatrixXd> svd(S);
    return (svd.singularValues().array() > 1e-10).count();
  };
  const auto of = " of " + std::to_string(joint.nv());
  findings.push_back({"information: rank of S", true, 0, 0,
                      std::to_string(rank(q)) + of + " at a random configuration, " + std::to_string(rank(joint.neutral())) + of + " at neutral"});
}

}  // namespace

void checkMotion(const JointProbe& joint, std::uint64_t seed, Findings& findings) {
  Random random(seed);
  std::vector<Eigen::VectorXd> samples;
  samples.reserve(sample_count + 1);
  for (int i = 0; i < sample_count; ++i) samples.push_back(randomConfiguration(joint, random));
  samples.push_back(joint.neutral());  // kinks and the limits of series often lie there
  checkPose(joint, samples, findings);
  if (joint.nv() == 0) return;
  checkSubspace(joint, samples, findings);
  if (joint.flat() || joint.instance().shape == Shape::dense) checkDual(joint, samples, findings);
  if (joint.instance().shape == Shape::dense) checkBias(joint, samples, random, findings);
  checkNeutral(joint, findings);
  checkClamps(joint, random, findings);
  checkRange(joint, random, findings);
  reportRank(joint, samples.front(), findings);
}

}  // namespace dyn::conformance
