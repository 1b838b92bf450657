// SPDX-License-Identifier: BSD-2-Clause
// A user's program: it reads a robot from a file and computes inverse and forward dynamics, collisions and distances. It prints a result that must
// not depend on how the program was compiled.
#include <dyn/dyn.hpp>
#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>
#include <dyn/parsers/urdf.hpp>

#include <cstdio>
#include <string>

/// Least distance of the robot, whose last body gets a sphere, from a hundred boxes in the world. So many boxes are searched with FCL's tree.
static double leastDistance(dyn::Model description, const Eigen::VectorXd& q) {
  description.addGeometry("tip", static_cast<int>(description.bodies.size()) - 1, {}, dyn::geometry::Sphere{0.05});
  for (int i = 0; i < 100; ++i)
    description.addGeometry("o" + std::to_string(i), 0, {dyn::Mat3<double>::identity(), {0.3 * (i % 10) + 0.2, 0.3 * (i / 10), 0.1}},
                            dyn::geometry::Box{{0.1, 0.1, 0.2}});
  const dyn::CompactModel model = dyn::compile(description, dyn::JointRegistry::standard());
  const dyn::GeometryModel geometry = dyn::compileGeometry(model, description);
  dyn::Data data(model);
  dyn::GeometryData placed(geometry);
  dyn::updateGeometryPlacements(model, data, geometry, placed, q);
  dyn::GeometryBatch batch(model, geometry, 4, 2);
  const Eigen::MatrixXd Q = q.replicate(1, 4);
  const bool any = dyn::computeCollisions(model, batch, Q).sum() > 0;
  const double distance = dyn::computeMinimumDistance(geometry, placed).distance;
  return any == (distance <= 0) && any == dyn::anyCollision(geometry, placed) ? distance : -1e9;
}

/// A robot described by designated initialisers, which name only the members that differ from their defaults.
static dyn::Model slider() {
  dyn::Model model;
  model.addBody(
      "carriage", 0,
      {.name = "rail", .type = "prismatic", .parameters = {{"axis", std::vector<double>{1, 0, 0}}}, .limits = {.lower = {-1}, .upper = {1}}});
  model.frames.push_back({.name = "tip", .body = 1});
  model.constraints.push_back({.name = "locked", .relation = dyn::JointLock{.joint = "rail"}});
  return model;
}

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    if (dyn::compile(slider(), dyn::JointRegistry::standard(), {.armature = false}).nv() != 1) return 1;
    const dyn::Model description = dyn::urdf::load(argv[1]);
    const dyn::CompactModel model = dyn::compile(description, dyn::JointRegistry::standard());
    dyn::Data data(model, dyn::Need::mass_matrix);
    const Eigen::VectorXd q = Eigen::VectorXd::Constant(model.nq(), 0.6);
    const Eigen::Matrix<double, 1, 1> v(0.3);  // a fixed-size matrix, aligned as this program's flags require
    Eigen::MatrixXd a = Eigen::MatrixXd::Constant(model.nv(), 2, -0.8);
    const Eigen::VectorXd tau = dyn::rnea(model, data, q, v, 2 * a.col(1) - a.col(0));
    const Eigen::VectorXd back = dyn::aba(model, data, q, v, tau);
    const Eigen::MatrixXd M = dyn::crba(model, data, q);
    if ((back - a.col(0)).norm() > 1e-12 || M(0, 0) <= 0) {
      std::fprintf(stderr, "rnea and aba disagree\n");
      return 1;
    }
    std::printf("tau %.15g M %.15g distance %.15g\n", tau[0], M(0, 0), leastDistance(description, q));
  } catch (const dyn::Error& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
