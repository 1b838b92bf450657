// SPDX-License-Identifier: BSD-2-Clause
// Sines and cosines of many joints together, read from their poses, at every angle and for the instruction set in use.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr int joints = 37;  // fills whole packs of every width and leaves a rest

/// Joints about z side by side. Their poses contain their cosines and sines.
const CompactModel& fan() {
  static const CompactModel model = [] {
    Model description;
    for (int i = 0; i < joints; ++i) {
      JointDescription joint;
      joint.name = "joint" + std::to_string(i);
      joint.type = "revolute";
      joint.parameters["axis"] = std::vector<double>{0, 0, 1};
      description.addBody("body" + std::to_string(i), 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
    }
    return compile(description, registry());
  }();
  return model;
}

/// Error of x in units of roundoff u. It is relative to the truth, or to `tiny` (the least normal number) if the truth is smaller.
double error(double x, long double truth, double u, double tiny) {
  return static_cast<double>(std::fabs(static_cast<long double>(x) - truth) / (u * std::max(std::fabs(truth), static_cast<long double>(tiny))));
}

double worstDouble(const std::vector<double>& angles) {
  static Data data(fan());
  double worst = 0;
  for (std::size_t first = 0; first + joints <= angles.size(); first += joints) {
    const Eigen::VectorXd q = Eigen::Map<const Eigen::VectorXd>(angles.data() + first, joints);
    forwardKinematics(fan(), data, q);
    for (int j = 0; j < joints; ++j) {
      const Mat3<double> R = jointPlacement(fan(), data, j + 1).R;
      const long double angle = q[j];
      worst = std::max({worst, error(R(0, 0), std::cos(angle), 0x1p-53, 1e-300), error(R(1, 0), std::sin(angle), 0x1p-53, 1e-300)});
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("sines and cosines are right to rounding at every finite angle", "[sincos]") {
  Random random(5);
  std::vector<double> angles;
  for (int i = 0; i < 200 * joints; ++i) {
    const double x = random.uniform(-1, 1);
    angles.push_back(i % 4 == 0 ? 4 * x : std::ldexp(x, random.below(2040) - 1020));
  }
  // Large angles, the ends of the number line, and angles next to multiples of pi / 2, where the reduced angle is smallest.
  for (const double x : {0.0, -0.0, 1e15, -1e15, 1e6, 1.6e6, 1e22, 1e308, 5e-324, 1e-310})
    for (int k = 0; k < joints; ++k) angles.push_back(x);
  for (int n = -20000; n < 20000; n += 7) {
    const double x = static_cast<double>(n * (3.14159265358979323846264338327950288L / 2));
    for (const double y : {std::nextafter(x, -1e300), x, std::nextafter(x, 1e300)}) angles.push_back(y);
  }
  // Angles at every distance from multiples of pi / 2, both those that the reduction subtracts in parts and others.
  for (int i = 0; i < 200 * joints; ++i) {
    const double multiple = std::round(std::ldexp(random.uniform(-1, 1), random.below(23)));
    angles.push_back(
        static_cast<double>(multiple * (3.14159265358979323846264338327950288L / 2) + std::ldexp(random.uniform(-1, 1), -random.below(60))));
  }
  CHECK(worstDouble(angles) < 1.2);  // rounding alone gives 1
}

TEST_CASE("the double that comes nearest to a multiple of pi / 2 keeps all digits", "[sincos]") {
  Data data(fan());
  forwardKinematics(fan(), data, Eigen::VectorXd::Constant(joints, 0x1.6ac5b262ca1ffp+849));
  for (int j = 1; j <= joints; ++j)  // the reference is from 60-digit arithmetic, because long double is not accurate enough here
    CHECK(error(jointPlacement(fan(), data, j).R(0, 0), -4.687165924254627611122582801963884e-19L, 0x1p-53, 0) < 1.2);
}

TEST_CASE("infinite angles give NaN where they are, and nowhere else", "[sincos]") {
  Data data(fan());
  Eigen::VectorXd q = Eigen::VectorXd::Constant(joints, 0.5);
  q[3] = std::numeric_limits<double>::infinity();
  q[17] = std::nan("");
  forwardKinematics(fan(), data, q);
  for (int j = 0; j < joints; ++j) {
    const double c = jointPlacement(fan(), data, j + 1).R(0, 0);
    if (j == 3 || j == 17) {
      CHECK(std::isnan(c));
    } else {
      CHECK(std::fabs(c - std::cos(0.5)) < 2e-16);
    }
  }
}

TEST_CASE("floats' sines and cosines are right to rounding", "[sincos]") {
  constexpr int states = 4000;
  Random random(6);
  Eigen::MatrixXf q(joints, states);
  for (float& x : q.reshaped()) x = static_cast<float>(std::ldexp(random.uniform(-1, 1), random.below(60) - 30));
  // The Jacobian column of a point on the x axis of a joint about z is (-sin, cos).
  Model description;
  JointDescription joint;
  joint.name = "joint";
  joint.type = "revolute";
  joint.parameters["axis"] = std::vector<double>{0, 0, 1};
  description.addBody("body", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  description.addFrame("tip", 1, {Mat3<double>::identity(), {1, 0, 0}});
  const CompactModel one = compile(description, registry());
  BatchDataFloat ones(one, joints * states, Need::jacobians);
  const Eigen::MatrixXf angles = q.reshaped(1, joints * states);
  const auto J = computeFrameJacobian(one, ones, angles, one.frameId("tip"), ReferenceFrame::LOCAL_WORLD_ALIGNED);
  double worst = 0;
  for (Eigen::Index k = 0; k < angles.cols(); ++k) {
    const long double angle = angles(0, k);
    worst = std::max({worst, error(-J(0, k), std::sin(angle), 0x1p-24, 1e-30), error(J(1, k), std::cos(angle), 0x1p-24, 1e-30)});
  }
  CHECK(worst < 1.2);
}
