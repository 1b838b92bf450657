// SPDX-License-Identifier: BSD-2-Clause
// The same mechanism in every format gives the same numbers.
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/load.hpp>

#include <algorithm>
#include <string>
#include <vector>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A mechanism in models/, in several formats. The first is the one with which the others are compared.
struct Mechanism {
  const char* name;
  const char* root;
  std::vector<const char*> formats;
  /// Added to the coordinates of SDF, whose zero configuration is the assembled mechanism.
  std::vector<double> sdf_shift{};
  Eigen::VectorXd shift(const std::string& format, int nq) const {
    if (format != "sdf" || sdf_shift.empty()) return Eigen::VectorXd::Zero(nq);
    return Eigen::Map<const Eigen::VectorXd>(sdf_shift.data(), nq);
  }
};

const std::vector<Mechanism> mechanisms{{"arm", "fixed", {"urdf", "mjcf", "lua", "sdf"}},
                                        {"biped", "free_flyer", {"urdf", "mjcf", "lua", "sdf"}},
                                        {"cart", "free_flyer", {"urdf", "mjcf", "lua", "sdf"}},
                                        {"four_bar", "fixed", {"urdf", "mjcf", "lua", "sdf"}, {0, -0.6073259925291629, -0.04197256229182978}}};

/// Whether this build reads a format.
bool built(const std::string& format) {
  for (const ModelFormat& known : modelFormats())
    if (known.name == format) return known.missing.empty();
  return false;
}

Model read(const Mechanism& mechanism, const std::string& format) {
  const bool mjcf = format == "mjcf";  // has its own joint between world and robot
  return load(std::string(DYN_SOURCE_DIR) + "/models/" + mechanism.name + "." + (mjcf ? "xml" : format),
              {.root = mjcf ? "fixed" : mechanism.root, .continuous = Continuous::angle});
}

std::vector<std::string> movingJoints(const CompactModel& model) {
  std::vector<std::string> out;
  for (const JointRecord& joint : model.joints())
    if (joint.nv > 0) out.push_back(joint.name);
  return out;
}

constexpr double tolerance = 1e-13;  // of the largest entry; formats give rotations and axes with the rounding of their readers

}  // namespace

TEST_CASE("a mechanism is the same in every format", "[parser]") {
  for (const Mechanism& mechanism : mechanisms) {
    const Model expected_model = read(mechanism, mechanism.formats.front());
    const CompactModel expected = compile(expected_model, registry(), {.dissipation = false});
    for (const std::string format : mechanism.formats) {
      INFO(mechanism.name << " in " << format);
      if (!built(format)) continue;
      const Model description = read(mechanism, format);
      const CompactModel model = compile(description, registry(), {.dissipation = false});
      REQUIRE(movingJoints(model) == movingJoints(expected));
      REQUIRE(model.nq() == expected.nq());
      Data data(model, Need::mass_matrix), reference(expected, Need::mass_matrix);
      Random random(7);
      for (int state = 0; state < 5; ++state) {
        const Eigen::VectorXd q = integrate(expected, neutral(expected), random.vector(expected.nv(), 1.0));
        const Eigen::VectorXd v = random.vector(expected.nv(), 2.0), a = random.vector(expected.nv(), 3.0);
        const Eigen::VectorXd own = q - mechanism.shift(format, expected.nq());
        CHECK(off(crba(model, data, own), crba(expected, reference, q)) < tolerance);
        CHECK(off(rnea(model, data, own, v, a), rnea(expected, reference, q, v, a)) < tolerance);
        CHECK(off(generalizedGravity(model, data, own), generalizedGravity(expected, reference, q)) < tolerance);
        forwardKinematics(model, data, own);
        forwardKinematics(expected, reference, q);
        for (const BodyDescription& body : expected_model.bodies) {
          if (body.name == "universe") continue;
          INFO(body.name);
          const SE3<double> x = framePlacement(model, data, model.frameId(body.name)),
                            y = framePlacement(expected, reference, expected.frameId(body.name));
          for (int k = 0; k < 9; ++k) CHECK(std::fabs(x.R.m[k] - y.R.m[k]) < tolerance);
          for (int k = 0; k < 3; ++k) CHECK(std::fabs(x.p[k] - y.p[k]) < tolerance);
        }
      }
    }
  }
}

TEST_CASE("a closed loop moves the same in every format", "[parser]") {
  const Mechanism& four_bar = mechanisms.back();
  Eigen::VectorXd first;
  for (const std::string format : four_bar.formats) {
    INFO(format);
    if (!built(format)) continue;
    Model description = read(four_bar, format);
    for (ConstraintDescription& loop : description.constraints) loop.baumgarte = {};  // a file's solver has it, not the mechanism
    const CompactModel model = compile(description, registry(), {.dissipation = false});
    const ConstraintSet set(model);
    REQUIRE(set.rows() == (format == "mjcf" ? 3 : 5));  // MuJoCo connects points, which makes a hinge in a plane
    Data data(model, Need::mass_matrix);
    ConstraintData constraints(set);
    Eigen::VectorXd q(3), v(3);
    q << 0.4, 0.5, 0.2;
    q -= four_bar.shift(format, 3);
    v << 2, 0, 0;
    const Assembly closed = projectConfiguration(model, data, q, constraints);
    REQUIRE(closed.closed);
    q = closed.q;
    v = projectVelocity(model, data, q, v, constraints);
    const Eigen::VectorXd a = constraintDynamics(model, data, q, v, Eigen::VectorXd::Zero(3), constraints).ddq;
    Eigen::VectorXd all(9);
    all << q + four_bar.shift(format, 3), v, a;
    if (first.size() == 0) first = all;
    CHECK(off(all, first) < 1e-9);
  }
}

TEST_CASE("URDF and MJCF of a mechanism have the same limits and volumes", "[parser]") {
  for (const Mechanism& mechanism : mechanisms) {
    INFO(mechanism.name);
    const Model urdf = read(mechanism, "urdf"), mjcf = read(mechanism, "mjcf");
    const CompactModel expected = compile(urdf, registry()), model = compile(mjcf, registry());
    REQUIRE(model.nq() == expected.nq());
    REQUIRE(model.nv() == expected.nv());
    CHECK(model.limits().lower == expected.limits().lower);
    CHECK(model.limits().upper == expected.limits().upper);
    CHECK(model.limits().effort == expected.limits().effort);
    REQUIRE(mjcf.geometries.size() == urdf.geometries.size());
    for (std::size_t i = 0; i < urdf.geometries.size(); ++i) {
      CHECK(mjcf.geometries[i].shape.index() == urdf.geometries[i].shape.index());
      CHECK(std::fabs(mjcf.geometries[i].placement.p.z - urdf.geometries[i].placement.p.z) < 1e-15);
    }
  }
}
