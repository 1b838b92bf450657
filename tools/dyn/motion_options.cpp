// SPDX-License-Identifier: BSD-2-Clause
#include "motion_options.hpp"

#include "contacts.hpp"
#include "options.hpp"

#include <dyn/geometry/contact_finder.hpp>

namespace dyn::tool {

void MotionOptions::add(CLI::App& app) {
  ModelOptions::add(app);
  app.add_option("--time", time, "seconds to simulate")->check(notNegative())->capture_default_str();
  app.add_option("--dt", dt, "seconds of a step; of the adaptive integrator the first one tried")->check(positive())->capture_default_str();
  std::vector<std::string> names;
  for (const IntegratorInfo& info : integrators()) names.emplace_back(info.name);
  app.add_option("--integrator", integrator, "method")->check(CLI::IsMember(names))->capture_default_str();
  app.add_option("--tolerance", tolerance, "of the adaptive integrator: error of a step [m, rad]")->check(positive())->capture_default_str();
  app.add_option("--contacts", contacts, "hold FRAME:3d (a point) or FRAME:6d where it is (repeatable)")->delimiter(',');
  app.add_option("--ground", ground, "frames whose origins touch the ground, a plane with z up (repeatable)")->delimiter(',');
  app.add_option("--ground-height", height, "z of the ground [m]")->capture_default_str();
  app.add_flag("--touching", touching, "bodies touch each other, and what --scene puts around them, by their collision volumes");
  volumes.add(app);
  for (const char* option : {"--scene", "--package", "--skip-missing"}) app.get_option(option)->needs("--touching");
  app.add_option("--friction", friction, "of contacts")->check(notNegative())->capture_default_str();
  app.add_flag("--limits", limits, "joints stop at their limits of position");
  app.add_option("--restitution", restitution, "of impacts of contacts and with limits")->check(inRange(0, 1))->capture_default_str();
}

SimulatorOptions MotionOptions::simulator() const {
  return {.integrator = integratorByName(integrator), .dt = dt, .tolerance = tolerance, .limits = limits, .restitution = restitution};
}

ConstraintSet MotionOptions::constraints(const CompactModel& model) const { return {ConstraintSet(model), readContacts(contacts)}; }

ContactFinder MotionOptions::finder(const CompactModel& model, const Model& description) const {
  return finder(model, touching ? std::optional(compileGeometry(model, description, volumes.geometry())) : std::nullopt);
}

ContactFinder MotionOptions::finder(const CompactModel& model, const std::optional<GeometryModel>& geometry) const {
  ContactFinder plane;
  if (!ground.empty()) plane = pointsOnPlane(model, ground, {0, 0, 1}, height, friction);
  return geometry ? together(plane, geometryContacts(model, *geometry, {.friction = friction})) : plane;
}

void assembleState(const CompactModel& model, const ConstraintSet& constraints, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  if (constraints.rows() == 0) return;
  Data data(model, Need::derivatives);
  ConstraintData loops(constraints);
  assemble(model, data, q, loops);
  v = Eigen::VectorXd(projectVelocity(model, data, q, v, loops));
}

}  // namespace dyn::tool
