// SPDX-License-Identifier: BSD-2-Clause
// Configuration-space functions: free flyer, spherical and planar compared with 60-digit references, and properties that hold for every joint type.
#include "errors.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <iostream>

using namespace dyn;
using namespace dyn::test;
using namespace dyn::tool;

namespace {

CompactModel single(const std::string& type, Parameters parameters = {}) {
  Model model;
  JointDescription joint;
  joint.name = "joint";
  joint.type = type;
  joint.parameters = std::move(parameters);
  model.addBody("body", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  return compile(model, registry());
}

Eigen::VectorXd vector(const nlohmann::json& x) {
  const std::vector<long double> numbers = flatten(x);
  return Eigen::Map<const Eigen::Matrix<long double, Eigen::Dynamic, 1>>(numbers.data(), static_cast<Eigen::Index>(numbers.size())).cast<double>();
}

/// Gives the quaternion in q the sign nearer to the reference, because q and -q are the same rotation.
Eigen::VectorXd nearerQuaternion(Eigen::VectorXd q, const Eigen::VectorXd& truth, const std::string& type) {
  if (type != "planar" && q.tail(4).dot(truth.tail(4)) < 0) q.tail(4) *= -1;
  return q;
}

}  // namespace

TEST_CASE("integrate, difference, interpolate and their Jacobians agree with 60 digits", "[lie]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json golden = readJson(sharedFolder() + "/golden/lie_groups.json");
  for (const std::string type : {"free_flyer", "spherical", "planar"}) {
    const CompactModel model = single(type);
    std::map<std::string, double> worst;
    const auto check = [&](const char* what, double angle, const Eigen::MatrixXd& x, const nlohmann::json& truth, double bar) {
      const double error = relativeError(rowMajor(x), flatten(truth));
      INFO(type << " " << what << " at " << angle << " rad: " << error << " u");
      CHECK(error <= bar);
      worst[what] = std::max(worst[what], error);
    };
    for (const nlohmann::json& c : golden[type]["cases"]) {
      const double angle = c["rotation_angle_of_v"];
      const Eigen::VectorXd q0 = vector(c["q0"]), v = vector(c["v"]), q1 = vector(c["integrate_q"]);
      const double exp_bar = 6 + angle;
      check("integrate", angle, nearerQuaternion(integrate(model, q0, v), q1, type), c["integrate_q"], exp_bar);
      check("dIntegrate_dq", angle, dIntegrate(model, q0, v, ArgumentPosition::ARG0), c["dIntegrate_dq"], exp_bar);
      check("dIntegrate_dv", angle, dIntegrate(model, q0, v, ArgumentPosition::ARG1), c["dIntegrate_dv"], exp_bar);
      const nlohmann::json& us = c["interpolate_u"];
      if (c["near_cut"]) continue;
      // q0 and q1 are rounded, which causes an absolute error of the angle of a few u.
      const std::vector<double> difference_found = rowMajor(difference(model, q0, q1));
      const std::vector<long double> truth = flatten(c["difference"]);
      const auto scale = static_cast<long double>(std::max({1.0, q0.cwiseAbs().maxCoeff(), q1.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()}));
      const double error = scaledError(difference_found, truth, std::vector<long double>(truth.size(), scale));
      INFO(type << " difference at " << angle << ": " << error);
      CHECK(error <= 8);
      worst["difference"] = std::max(worst["difference"], error);
      for (std::size_t k = 0; k < us.size(); ++k)
        check("interpolate", angle, nearerQuaternion(interpolate(model, q0, q1, us[k]), vector(c["interpolate_q"][k]), type), c["interpolate_q"][k],
              8);
      if (c["dDifference_dq0"].is_null()) continue;
      check("dDifference_dq0", angle, dDifference(model, q0, q1, ArgumentPosition::ARG0), c["dDifference_dq0"], 20);
      check("dDifference_dq1", angle, dDifference(model, q0, q1, ArgumentPosition::ARG1), c["dDifference_dq1"], 20);
    }
    if (std::getenv("DYN_SHOW_ERRORS"))
      for (const auto& [what, error] : worst) std::cout << type << " " << what << " " << error << " u\n";
  }
}

namespace {

/// A model with every loaded joint type.
struct EveryType {
  explicit EveryType(std::uint64_t seed)
      : model(compile(randomTree(registry(), static_cast<int>(registry().jointTypes().size()), seed), registry())) {}
  CompactModel model;
  Eigen::VectorXd somewhere(std::uint64_t seed, double reach = 0.8) const {
    Random random(seed);
    return integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), reach)));
  }
};

double worst(const Eigen::MatrixXd& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("difference takes back what integrate added, for every joint type", "[lie]") {
  const int seed = GENERATE(range(1, 10));
  const EveryType every(static_cast<std::uint64_t>(seed));
  Random random(static_cast<std::uint64_t>(seed));
  const Eigen::VectorXd q = every.somewhere(11), v = random.vector(every.model.nv(), 1.5);
  const Eigen::VectorXd q1 = integrate(every.model, q, v);
  CHECK(worst(difference(every.model, q, q1) - v) < 1e-14);
  CHECK(isNormalized(every.model, q1, 4e-16));
  CHECK(worst(difference(every.model, q, q)) == 0);
  CHECK(distance(every.model, q, q1) == approx(v.norm()));
  CHECK(worst(difference(every.model, integrate(every.model, q, Eigen::VectorXd(0.3 * v)), interpolate(every.model, q, q1, 0.3))) < 1e-14);
  CHECK(worst(difference(every.model, q, interpolate(every.model, q, q1, 0))) < 1e-15);
  CHECK(worst(difference(every.model, q1, interpolate(every.model, q, q1, 1))) < 1e-14);
}

TEST_CASE("dIntegrate and dDifference are the derivatives, for every joint type", "[lie]") {
  const int seed = GENERATE(range(1, 6));
  const EveryType every(static_cast<std::uint64_t>(seed));
  const CompactModel& m = every.model;
  Random random(static_cast<std::uint64_t>(seed));
  const Eigen::VectorXd q = every.somewhere(21), v = random.vector(m.nv(), 0.9), q1 = integrate(m, q, v);
  const auto column = [&](auto&& at) {
    // Central difference of fourth order of a tangent-valued function of a step.
    constexpr double h = 1e-3;
    return Eigen::VectorXd((8.0 * (at(h) - at(-h)) - (at(2 * h) - at(-2 * h))) / (12 * h));
  };
  Eigen::MatrixXd dq(m.nv(), m.nv()), dv(m.nv(), m.nv()), d0(m.nv(), m.nv()), d1(m.nv(), m.nv());
  for (Eigen::Index k = 0; k < m.nv(); ++k) {
    const auto moved = [&](const Eigen::VectorXd& x, double h) { return integrate(m, x, Eigen::VectorXd(h * Eigen::VectorXd::Unit(m.nv(), k))); };
    dq.col(k) = column([&](double h) { return difference(m, q1, integrate(m, moved(q, h), v)); });
    dv.col(k) = column([&](double h) { return difference(m, q1, integrate(m, q, Eigen::VectorXd(v + h * Eigen::VectorXd::Unit(m.nv(), k)))); });
    d0.col(k) = column([&](double h) { return difference(m, moved(q, h), q1); });
    d1.col(k) = column([&](double h) { return difference(m, q, moved(q1, h)); });
  }
  CHECK(worst(dIntegrate(m, q, v, ArgumentPosition::ARG0) - dq) < 1e-10);
  CHECK(worst(dIntegrate(m, q, v, ArgumentPosition::ARG1) - dv) < 1e-10);
  CHECK(worst(dDifference(m, q, q1, ArgumentPosition::ARG0) - d0) < 1e-10);
  CHECK(worst(dDifference(m, q, q1, ArgumentPosition::ARG1) - d1) < 1e-10);
}

TEST_CASE("results may be written into the caller's memory, over the input too", "[lie]") {
  const EveryType every(3);
  const CompactModel& m = every.model;
  Random random(5);
  const Eigen::VectorXd q = every.somewhere(31), v = random.vector(m.nv(), 1), q1 = integrate(m, q, v);
  Eigen::VectorXd in_place = q;
  integrate(m, in_place, v, in_place);
  CHECK(in_place == q1);
  Eigen::VectorXd both(m.nq() + m.nv());
  difference(m, q, q1, both.tail(m.nv()));
  CHECK(both.tail(m.nv()) == difference(m, q, q1));
  normalize(m, 3 * q, both.head(m.nq()));
  CHECK(worst(both.head(m.nq()) - normalize(m, 3 * q)) == 0);
  Eigen::MatrixXd large = Eigen::MatrixXd::Constant(m.nv() + 3, m.nv() + 2, 7);
  dIntegrate(m, q, v, ArgumentPosition::ARG1, large.block(1, 2, m.nv(), m.nv()));
  CHECK(large.block(1, 2, m.nv(), m.nv()) == dIntegrate(m, q, v, ArgumentPosition::ARG1));
  CHECK(large.topRows(1).isConstant(7));
  CHECK(large.leftCols(2).isConstant(7));
  CHECK(large.bottomRows(2).isConstant(7));
  Eigen::VectorXd small(m.nq() - 1);
  CHECK_THROWS_WITH(integrate(m, q, v, small), containing("the result has " + std::to_string(m.nq() - 1)));
  CHECK_THROWS_AS(dIntegrate(m, q, v, ArgumentPosition::ARG0, large), Error);
}

TEST_CASE("quaternions are normalised where they are read, whatever their length; -q is the same rotation", "[lie]") {
  for (const std::string type : {"spherical", "free_flyer", "planar", "continuous"}) {
    const CompactModel m = single(type, type == "continuous" ? Parameters{{"axis", std::vector<double>{0, 0, 1}}} : Parameters{});
    Data data(m);
    const int rotation = type == "planar" || type == "continuous" ? 2 : 4;
    Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(m.nv(), 0.3, 0.9);
    const Eigen::VectorXd q = integrate(m, neutral(m), v), q1 = integrate(m, q, v);
    const Eigen::VectorXd tau = rnea(m, data, q, v, v);
    for (const double length : {3.0, 1e-3, 1e-150, 1e-200, 1e-300, 1e150, 1e200, 1e300}) {
      INFO(type << " of length " << length);
      Eigen::VectorXd scaled = q;
      scaled.tail(rotation) *= length;
      CHECK(!isNormalized(m, scaled));
      CHECK(isNormalized(m, normalize(m, scaled), 4e-16));
      CHECK(worst(normalize(m, scaled) - q) < 4e-16);
      CHECK(worst(difference(m, scaled, q1) - v) < 2e-15);
      CHECK(worst(integrate(m, scaled, v) - q1) < 2e-15);
      CHECK(worst(rnea(m, data, scaled, v, v) - tau) < 2e-14);
    }
    if (rotation == 4) {
      Eigen::VectorXd negative = q1;
      negative.tail(4) *= -1;
      CHECK(worst(difference(m, q, negative) - difference(m, q, q1)) == 0);
      CHECK(worst(difference(m, q1, negative)) < 1e-15);
      CHECK(worst(rnea(m, data, negative, v, v) - rnea(m, data, q1, v, v)) < 1e-15);
    }
    Eigen::VectorXd zero = q;
    zero.tail(rotation).setZero();
    CHECK(!isNormalized(m, zero));
    CHECK_THROWS_WITH(integrate(m, zero, v), containing("joint") && containing("zero"));
    CHECK_THROWS_WITH(difference(m, q, zero), containing("q1"));
    CHECK_THROWS_AS(normalize(m, zero), Error);
    CHECK_THROWS_AS(rnea(m, data, zero, v, v), Error);
  }
}

TEST_CASE("NaN and infinity spread or are refused, and nothing hangs", "[lie]") {
  const EveryType every(4);
  const CompactModel& m = every.model;
  Data data(m, Need::mass_matrix);
  const Eigen::VectorXd q = every.somewhere(41), v = Eigen::VectorXd::Ones(m.nv());
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
    for (Eigen::Index k = 0; k < m.nq(); ++k) {
      Eigen::VectorXd x = q;
      x[k] = bad;
      INFO("q[" << k << "] = " << bad);
      bool caught = false;
      try {
        const Eigen::VectorXd tau = rnea(m, data, x, v, v), back = difference(m, q, integrate(m, x, v));
        caught = !tau.allFinite() || !back.allFinite();
      } catch (const Error&) {
        caught = true;
      }
      CHECK(caught);
    }
}

TEST_CASE("random configurations lie within the limits, differ by seed and come back", "[lie]") {
  Model description = randomTree(registry(), 30, 8);
  for (BodyDescription& b : description.bodies)
    if (b.joint.type == "revolute" || b.joint.type == "prismatic") b.joint.limits = {{-0.2}, {0.7}, {}, {}};
  const CompactModel m = compile(description, registry());
  int limited = 0;
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    const Eigen::VectorXd q = randomConfiguration(m, seed);
    CHECK(isNormalized(m, q, 4e-16));
    CHECK(q == randomConfiguration(m, seed));
    CHECK(q != randomConfiguration(m, seed + 1));
    for (const JointRecord& r : m.joints()) {
      const BodyDescription& b = description.bodies[static_cast<std::size_t>(std::max(0, description.findJoint(r.name)))];
      if (b.joint.limits.lower.empty()) continue;
      ++limited;
      CHECK(q[r.idx_q] >= -0.2);
      CHECK(q[r.idx_q] <= 0.7);
    }
  }
  CHECK(limited > 0);
}

TEST_CASE("random configurations are finite and within whatever limits there are", "[lie]") {
  constexpr double none = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
  struct Limits {
    double lower, upper;
  };
  for (const Limits x : {Limits{4, none}, {-none, -7}, {-most, most}, {-1.5e308, 1.6e308}, {2e16, none}, {0.1, 0.1}, {-none, none}, {-0.3, 0.7}})
    for (const char* type : {"free_flyer", "planar", "translation", "prismatic", "revolute"}) {
      CAPTURE(type, x.lower, x.upper);
      Model model;
      JointDescription joint;
      joint.name = "joint";
      joint.type = type;
      const bool one = std::string(type) == "prismatic" || std::string(type) == "revolute";
      if (one) joint.parameters["axis"] = std::vector<double>{0, 0, 1};
      const int positions = one ? 1 : std::string(type) == "planar" ? 2 : 3;
      const std::size_t nq = one ? 1 : std::string(type) == "planar" ? 4 : std::string(type) == "translation" ? 3 : 7;
      joint.limits.lower.assign(nq, -none);
      joint.limits.upper.assign(nq, none);
      joint.limits.lower[static_cast<std::size_t>(positions - 1)] = x.lower;
      joint.limits.upper[static_cast<std::size_t>(positions - 1)] = x.upper;
      model.addBody("body", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
      const CompactModel m = compile(model, registry());
      for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const Eigen::VectorXd q = randomConfiguration(m, seed);
        REQUIRE(q.allFinite());
        REQUIRE(q[positions - 1] >= x.lower);
        REQUIRE(q[positions - 1] <= x.upper);
      }
    }
}

TEST_CASE("random rotations are even over their group", "[lie]") {
  // The angle of a uniformly distributed rotation has the density (1 - cos angle) / pi, and its axis prefers no direction.
  for (const char* type : {"spherical", "free_flyer"}) {
    const CompactModel m = single(type);
    constexpr int count = 20000;
    Eigen::Vector4d fourths = Eigen::Vector4d::Zero();
    Eigen::Matrix4d squares = Eigen::Matrix4d::Zero();
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector4d x = randomConfiguration(m, static_cast<std::uint64_t>(k)).tail(4);
      squares += x * x.transpose() / count;
      fourths += x.array().pow(4).matrix() / count;
    }
    // The means of x^2 and x^4 over the unit sphere in R^4 are 1/4 and 1/8. The bounds are six standard deviations.
    CHECK((squares - 0.25 * Eigen::Matrix4d::Identity()).cwiseAbs().maxCoeff() < 6 * std::sqrt(1.0 / 16 / count));
    CHECK((fourths.array() - 0.125).abs().maxCoeff() < 6 * std::sqrt((7.0 / 128 - 1.0 / 64) / count));
  }
}
