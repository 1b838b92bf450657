// SPDX-License-Identifier: BSD-2-Clause
// Errors where the mass matrix has no inverse: the message names the true reason.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn_sdk/joint_plugin.hpp>

#include <Eigen/LU>

using namespace dyn;
using namespace dyn::test;

namespace {

/// Angles about z, y and x. The first and the last axis coincide where the second angle is a right angle.
struct Gimbals : sdk::Joint<Gimbals, 3> {
  static constexpr const char* name = "gimbals";
  static constexpr const char* summary = "angles about z, y and x";
  template <class S>
  static SE3<S> pose(const S* q, const sdk::Constants&) {
    return {exp3(Vec3<S>{S(0), S(0), q[0]}) * exp3(Vec3<S>{S(0), q[1], S(0)}) * exp3(Vec3<S>{q[2], S(0), S(0)}), {}};
  }
};
/// A slider at position log(q), which is not a number for q < 0.
struct Logarithm : sdk::Joint<Logarithm, 1> {
  static constexpr const char* name = "logarithm";
  static constexpr const char* summary = "slides along x by log(q)";
  template <class S>
  static SE3<S> pose(const S* q, const sdk::Constants&) {
    using std::log;
    return {Mat3<S>::identity(), {log(q[0]), S(0), S(0)}};
  }
};

const Inertia<double> solid{1, {0.1, 0, 0.2}, {1, 0, 0, 1, 0, 1}};

CompactModel hung(const std::vector<std::string>& types, const Inertia<double>& last) {
  static const JointRegistry types_known = [] {
    static const sdk::JointTypeOf<Gimbals> gimbals;
    static const sdk::JointTypeOf<Logarithm> logarithm;
    JointRegistry r = JointRegistry::standard();
    r.add(gimbals);
    r.add(logarithm);
    return r;
  }();
  Model m;
  for (const std::string& type : types) {
    JointDescription joint;
    joint.name = "j" + std::to_string(m.bodies.size());
    joint.type = type;
    if (type == "revolute") joint.parameters["axis"] = std::vector<double>{0, 0, 1};
    const int parent = static_cast<int>(m.bodies.size()) - 1;
    m.addBody("b" + std::to_string(m.bodies.size()), parent, joint, m.bodies.size() == types.size() ? last : Inertia<double>{});
  }
  return compile(m, types_known);
}

std::string refused(const CompactModel& model, const Eigen::VectorXd& q) {
  Data data(model, Need::derivatives);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(model.nv());
  try {
    aba(model, data, q, zero, zero);
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::singular);
    CHECK_THROWS_AS(computeMinverse(model, data, q), Error);
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("where M is singular the message says why", "[singular]") {
  const CompactModel gimbals = hung({"gimbals"}, solid);
  CHECK(refused(gimbals, Eigen::Vector3d(0.3, 0.4, 0.5)).empty());
  CHECK_THAT(refused(gimbals, Eigen::Vector3d(0.3, M_PI / 2, 0.5)),
             containing("joint 'j1'") && containing("the rank of its motion is 2 there, of 3"));
  CHECK_THAT(refused(hung({"revolute"}, {}), Eigen::VectorXd::Zero(1)), containing("has no inertia; give its bodies mass"));
  CHECK_THAT(refused(hung({"revolute", "revolute"}, solid), Eigen::VectorXd::Zero(2)),
             containing("joint 'j1'") && containing("axes that are aligned"));
}

TEST_CASE("poses that are no numbers are told by their joint, and not taken for missing mass", "[singular]") {
  const CompactModel model = hung({"revolute", "logarithm"}, solid);
  CHECK(refused(model, Eigen::Vector2d(0.1, 1)).empty());
  CHECK_THAT(refused(model, Eigen::Vector2d(0.1, -1)), containing("joint 'j2'") && containing("q = (-1) is not finite") && containing("'logarithm'"));
}

TEST_CASE("masses whose products overflow are told as such", "[singular]") {
  const CompactModel model = hung({"revolute", "gimbals"}, {1e300, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}});
  CHECK_THAT(refused(model, Eigen::Vector4d(0.1, 0.2, 0.3, 0.4)), containing("a mass of 1e+300 kg") && containing("check the units"));
}

TEST_CASE("the condition of M is estimated within a factor of three, whatever the sizes of bodies", "[singular]") {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Model description = randomTree(registry(), 4 + static_cast<int>(seed), seed);
    if (seed % 2 == 0) {
      // In one model of four all masses are a million times smaller.
      for (BodyDescription& body : description.bodies) body.inertia.mass *= seed % 4 == 0 ? 1 : 1e-6;
    }
    const CompactModel model = compile(description, registry());
    Data data(model, Need::derivatives);
    Random random(seed);
    const Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 1)));
    const Eigen::MatrixXd M = crba(model, data, q);
    cholesky::decompose(model, data);
    const double estimate = conditionOfMassMatrix(model, data);
    const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal(), inverse = scaled.inverse();
    const double condition = scaled.cwiseAbs().colwise().sum().maxCoeff() * inverse.cwiseAbs().colwise().sum().maxCoeff();
    CAPTURE(seed, condition, estimate);
    CHECK(estimate <= condition * (1 + 1e-12 * condition));
    CHECK(estimate >= condition / 3);
  }
}

TEST_CASE("the condition of M is known with joints that follow others, too", "[singular]") {
  Model description = randomTree(registry(), 6, 3);
  JointDescription slider;
  slider.name = "leads";
  slider.type = "prismatic";
  slider.parameters["axis"] = std::vector<double>{0, 1, 0};
  const int body = description.addBody("first", 0, slider, solid);
  slider.name = "follows";
  slider.coupling = {"mimic", "leads", {{"coefficients", std::vector<double>{0, 0.5}}}};
  description.addBody("second", body, slider, solid);
  const CompactModel model = compile(description, registry());
  REQUIRE(model.follows());
  Data data(model, Need::mass_matrix);
  const Eigen::MatrixXd M = crba(model, data, randomConfiguration(model, 3));
  const Eigen::VectorXd scale = M.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * M * scale.asDiagonal(), inverse = scaled.inverse();
  const double condition = scaled.cwiseAbs().colwise().sum().maxCoeff() * inverse.cwiseAbs().colwise().sum().maxCoeff();
  const double estimate = conditionOfMassMatrix(model, data);
  CHECK(estimate <= condition * (1 + 1e-12));
  CHECK(estimate >= condition / 3);
}
