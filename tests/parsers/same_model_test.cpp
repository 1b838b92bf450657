// SPDX-License-Identifier: BSD-2-Clause
// The models of ../models stand there in several formats. All of them describe the same mechanism, and so give the same numbers.
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/registry.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/load.hpp>

#include <random>

using namespace dyn;
using namespace dyn::test;

namespace {

/// One mechanism: its files, and how they are loaded so that their coordinates are the same.
struct Mechanism {
  const char* name;
  std::vector<const char*> files;
  const char* root;  ///< root joint of formats that leave it to the caller
};

const std::vector<Mechanism> mechanisms{
    {"arm", {"arm.urdf", "arm.xml"}, "fixed"},
    {"biped", {"biped.urdf", "biped.xml"}, "free_flyer"},
    {"four_bar", {"four_bar.urdf", "four_bar.xml"}, "fixed"},
};

Model read(const Mechanism& m, const std::string& file) {
  LoadOptions options;
  options.continuous = Continuous::angle;
  // MJCF has its own joint between world and robot.
  if (file.ends_with(".urdf")) options.root = m.root;
  return load(DYN_SOURCE_DIR "/models/" + file, options);
}

Eigen::VectorXd random(int n, unsigned seed) {
  std::mt19937 engine(seed);
  Eigen::VectorXd x(n);
  for (int i = 0; i < n; ++i) x[i] = std::uniform_real_distribution<double>(-1, 1)(engine);
  return x;
}

}  // namespace

TEST_CASE("all formats of a model have the same joints and limits", "[parser]") {
  for (const Mechanism& m : mechanisms) {
    const CompactModel first = compile(read(m, m.files[0]), registry());
    for (const char* file : m.files) {
      INFO(file);
      const CompactModel model = compile(read(m, file), registry());
      REQUIRE(model.nq() == first.nq());
      REQUIRE(model.nv() == first.nv());
      REQUIRE(model.njoints() == first.njoints());
      for (int j = 1; j < model.njoints(); ++j) CHECK(model.joints()[std::size_t(j)].name == first.joints()[std::size_t(j)].name);
      for (int i = 0; i < model.nq(); ++i) {
        CHECK(model.limits().lower[std::size_t(i)] == first.limits().lower[std::size_t(i)]);
        CHECK(model.limits().upper[std::size_t(i)] == first.limits().upper[std::size_t(i)]);
      }
      for (int i = 0; i < model.nv(); ++i) CHECK(model.limits().effort[std::size_t(i)] == first.limits().effort[std::size_t(i)]);
    }
  }
}

TEST_CASE("all formats of a model give the same forces, mass matrix and poses", "[parser]") {
  for (const Mechanism& m : mechanisms) {
    const CompactModel first = compile(read(m, m.files[0]), registry());
    Data expected(first, Need::mass_matrix);
    const Eigen::VectorXd v = random(first.nv(), 1), a = random(first.nv(), 2);
    const Eigen::VectorXd q = integrate(first, neutral(first), random(first.nv(), 3));
    const Eigen::VectorXd tau = rnea(first, expected, q, v, a);
    const Eigen::MatrixXd M = crba(first, expected, q);
    forwardKinematics(first, expected, q);
    for (const char* file : m.files) {
      INFO(file);
      const CompactModel model = compile(read(m, file), registry());
      Data data(model, Need::mass_matrix);
      CHECK(off(rnea(model, data, q, v, a), tau) < 1e-13);
      CHECK(off(crba(model, data, q), M) < 1e-13);
      forwardKinematics(model, data, q);
      for (const FrameRecord& frame : first.frames()) {
        if (model.findFrame(frame.name) < 0) continue;
        const SE3<double> X = framePlacement(model, data, model.frameId(frame.name)), Y = framePlacement(first, expected, first.frameId(frame.name));
        CHECK(off(Eigen::Map<const Eigen::VectorXd>(X.R.m, 9), Eigen::Map<const Eigen::VectorXd>(Y.R.m, 9)) < 1e-14);
        CHECK(std::hypot(X.p.x - Y.p.x, X.p.y - Y.p.y, X.p.z - Y.p.z) < 1e-14);
      }
    }
  }
}

TEST_CASE("all formats of a model have the same volumes", "[parser]") {
  for (const Mechanism& m : mechanisms) {
    const Model first = read(m, m.files[0]);
    for (const char* file : m.files) {
      INFO(file);
      const Model model = read(m, file);
      REQUIRE(model.geometries.size() == first.geometries.size());
      for (std::size_t i = 0; i < model.geometries.size(); ++i) {
        CHECK(model.geometries[i].shape.index() == first.geometries[i].shape.index());
        CHECK(std::fabs(model.geometries[i].placement.p.z - first.geometries[i].placement.p.z) < 1e-15);
      }
    }
  }
}

TEST_CASE("all formats of a closed loop move alike", "[parser]") {
  for (const Mechanism& m : mechanisms) {
    const Model description = read(m, m.files[0]);
    if (description.constraints.empty()) continue;
    std::vector<Eigen::VectorXd> accelerations;
    for (const char* file : m.files) {
      INFO(file);
      Model loop = read(m, file);
      // Feedback belongs to a file's solver, not to the mechanism.
      for (ConstraintDescription& c : loop.constraints) c.baumgarte = {};
      const CompactModel model = compile(loop, registry());
      Data data(model);
      ConstraintData constraints{ConstraintSet(model)};
      Eigen::VectorXd q = neutral(model);
      q[0] = 0.4;
      const Assembly closed = projectConfiguration(model, data, q, constraints);
      REQUIRE(closed.closed);
      accelerations.push_back(constraintDynamics(model, data, closed.q, Eigen::VectorXd::Zero(model.nv()), random(model.nv(), 4), constraints).ddq);
      CHECK(off(accelerations.back(), accelerations.front()) < 1e-9);
    }
  }
}
