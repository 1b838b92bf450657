// SPDX-License-Identifier: BSD-2-Clause
// The example plugins compared with closed forms of their geometry, and the robots that come with them.
#include "support/catch.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <Eigen/Dense>

#include <filesystem>

using namespace dyn;
using namespace dyn::test;

namespace {

CompactModel carry(const std::string& type, const Parameters& parameters, const Inertia<double>& inertia = {1, {}, {1, 0, 0, 1, 0, 1}}) {
  Model model;
  JointDescription joint;
  joint.name = "joint";
  joint.type = type;
  joint.parameters = parameters;
  model.addBody("body", 0, joint, inertia);
  return compile(model, registry());
}

SE3<double> poseAt(const CompactModel& model, const Eigen::VectorXd& q) {
  Data data(model);
  forwardKinematics(model, data, q);
  return framePlacement(model, data, model.frameId("body"));
}
SE3<double> poseAt(const CompactModel& model, double q) { return poseAt(model, Eigen::VectorXd::Constant(1, q)); }

using Numbers = std::vector<double>;

}  // namespace

TEST_CASE("the robot of every example folder loads and its forward dynamics inverts its inverse dynamics", "[examples]") {
  int robots = 0;
  for (const auto& file : std::filesystem::recursive_directory_iterator(DYN_SOURCE_DIR "/plugins/examples")) {
    if (file.path().extension() != ".urdf") continue;
    INFO(file.path());
    ++robots;
    const CompactModel model = compile(urdf::load(file.path().string()), registry());
    Data data(model);
    const Eigen::VectorXd q = randomConfiguration(model, 3), v = Eigen::VectorXd::LinSpaced(model.nv(), 0.3, 0.8), a = -v;
    const Eigen::VectorXd tau = rnea(model, data, q, v, a);
    CHECK((Eigen::VectorXd(aba(model, data, q, v, tau)) - a).norm() < 1e-10);
  }
  CHECK(robots == 5);
}

TEST_CASE("a rail that turns once around closes, and its arcs are circles", "[examples]") {
  const double pi = std::acos(-1.0), k = 1.25;
  const CompactModel rail = carry("planar_rail", {{"segments", Numbers{2, 0, 2 * pi / k, k, 1, 0}}});
  for (const double d : {0.0, 0.1, 1.0, 3.0, 4.9}) {
    const SE3<double> X = poseAt(rail, 2 + d);
    CHECK(X.p.x == approx(2 + std::sin(k * d) / k).margin(1e-14));
    CHECK(X.p.y == approx((1 - std::cos(k * d)) / k).margin(1e-14));
    CHECK(X.R(1, 0) == approx(std::sin(k * d)).margin(1e-14));
  }
  const SE3<double> before = poseAt(rail, 2), after = poseAt(rail, 2 + 2 * pi / k);
  for (int i = 0; i < 3; ++i) CHECK(before.p[i] == approx(after.p[i]).margin(1e-14));
  CHECK(poseAt(rail, -3).p.x == approx(-3));                     // the rail goes straight on before the start
  CHECK(poseAt(rail, 2 + 2 * pi / k + 7).p.x == approx(2 + 7));  // and after the end
}

TEST_CASE("a carriage keeps its speed along an arc without a force, and needs its mass and its moment to speed up", "[examples]") {
  const Inertia<double> Y{3, {}, {1, 0, 0, 1, 0, 0.5}};
  const CompactModel rail = carry("planar_rail", {{"segments", Numbers{10, 0.5}}}, Y);
  Data data(rail);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 2), v = Eigen::VectorXd::Constant(1, 4), zero = Eigen::VectorXd::Zero(1),
                        one = Eigen::VectorXd::Ones(1);
  CHECK(rnea(rail, data, q, v, zero)[0] == approx(0).margin(1e-12));
  CHECK(rnea(rail, data, q, v, one)[0] == approx(3 + 0.5 * 0.25));
}

TEST_CASE("a function joint's spline is the natural cubic through its knots and goes on straight", "[examples]") {
  const Numbers x{-1, -0.2, 0.5, 1.5, 1.8}, y{0.3, 0.1, 0.4, -0.2, 0.6};
  Numbers knots;
  for (std::size_t k = 0; k < x.size(); ++k) knots.insert(knots.end(), {x[k], y[k]});
  const CompactModel joint =
      carry("function_joint", {{"tx_spline", knots}, {"tz_polynomial", Numbers{0.5, -1, 2}}, {"r2_polynomial", Numbers{0, 1}}});
  // The same spline as the sum of a line and truncated cubes: s(t) = a + b t + sum_k c_k (t - x_k)_+^3 with sum c_k = sum c_k x_k = 0.
  const auto n = static_cast<Eigen::Index>(x.size());
  const auto at = [](Eigen::Index i) { return static_cast<std::size_t>(i); };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n + 2, n + 2);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n + 2);
  for (Eigen::Index i = 0; i < n; ++i) {
    A(i, 0) = 1;
    A(i, 1) = x[at(i)];
    for (Eigen::Index k = 0; k < n; ++k) A(i, 2 + k) = std::pow(std::max(0.0, x[at(i)] - x[at(k)]), 3);
    b[i] = y[at(i)];
    A(n, 2 + i) = 1;
    A(n + 1, 2 + i) = x[at(i)];
  }
  const Eigen::VectorXd c = A.fullPivLu().solve(b);
  for (double t = -3; t <= 4; t += 0.07) {
    double expected = c[0] + c[1] * t;
    for (Eigen::Index k = 0; k < n; ++k) expected += c[2 + k] * std::pow(std::max(0.0, t - x[at(k)]), 3);
    const SE3<double> X = poseAt(joint, t);
    CHECK(X.p.x == approx(expected).margin(1e-12));
    CHECK(X.p.y == 0);
    CHECK(X.p.z == approx(0.5 - t + 2 * t * t));
    CHECK(X.R(0, 2) == approx(std::sin(t)).margin(1e-14));
  }
}

TEST_CASE("a function joint of two coordinates takes each function of the coordinate that is named", "[examples]") {
  const CompactModel joint =
      carry("function_joint2", {{"tx_polynomial", Numbers{0, 1}}, {"ty_polynomial", Numbers{0, 0, 3}}, {"ty_coordinate", Numbers{1}}});
  REQUIRE(joint.nv() == 2);
  const SE3<double> X = poseAt(joint, Eigen::Vector2d(0.5, 2));
  CHECK(X.p.x == approx(0.5));
  CHECK(X.p.y == approx(12));
}

TEST_CASE("parameters that describe no rail or function are refused with the reason", "[examples]") {
  CHECK_THROWS_WITH(carry("planar_rail", {{"segments", Numbers{1, 0, 2}}}), containing("pairs"));
  CHECK_THROWS_WITH(carry("planar_rail", {{"segments", Numbers{1, 0, 0, 1}}}), containing("greater than 0"));
  CHECK_THROWS_WITH(carry("function_joint", {{"tx_spline", Numbers{0, 1, 0, 2}}}), containing("tx") && containing("growing x"));
  CHECK_THROWS_WITH(carry("function_joint", {{"r1_spline", Numbers{0, 1, 1, 2}}, {"r1_polynomial", Numbers{1}}}),
                    containing("r1") && containing("not both"));
  CHECK_THROWS_WITH(carry("function_joint", {{"tz_polynomial", Numbers{0, 1}}, {"tz_coordinate", Numbers{1}}}),
                    containing("tz") && containing("no coordinate"));
  CHECK_THROWS_WITH(carry("function_joint", {{"axis2", Numbers{0, 0, 0}}}), containing("axis"));
}
