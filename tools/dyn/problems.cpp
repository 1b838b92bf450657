// SPDX-License-Identifier: BSD-2-Clause
#include "problems.hpp"

#include <cmath>

namespace dyn::tool {

int addBar(Model& model, const std::string& joint, int parent, const std::vector<double>& axis, const Vec3<double>& at, const Inertia<double>& Y) {
  JointDescription revolute;
  revolute.name = joint;
  revolute.type = "revolute";
  revolute.parameters["axis"] = axis;
  revolute.placement.p = at;
  return model.addBody(joint + "_link", parent, revolute, Y);
}

Model pendulum(int rods) {
  Model model;
  model.name = "pendulum_" + std::to_string(rods);
  int parent = 0;
  for (int k = 0; k < rods; ++k) {
    const Vec3<double> at = k > 0 ? Vec3<double>{0, 0, -1} : Vec3<double>{};
    parent = addBar(model, "j" + std::to_string(k + 1), parent, {0, 1, 0}, at, {1, {0, 0, -1}, {}});
  }
  return model;
}

Model chain(int links) {
  Model model;
  model.name = "chain_" + std::to_string(links);
  int parent = 0;
  for (int k = 0; k < links; ++k) {
    const double turn = 2.4 * k, mass = 1 + 0.5 * (k % 3);
    const Vec3<double> at = k > 0 ? Vec3<double>{0.3, 0, 0} : Vec3<double>{};
    const Inertia<double> link{mass, {0.15, 0.01, -0.02}, {0.002 * mass, 0, 0, 0.009 * mass, 0, 0.01 * mass}};
    parent = addBar(model, "j" + std::to_string(k + 1), parent, {0.2, std::cos(turn), std::sin(turn)}, at, link);
  }
  return model;
}

Model body(const std::string& type, double mass, const Vec3<double>& com, const Vec3<double>& moments, double gravity) {
  Model model;
  model.name = type;
  model.gravity = {0, 0, -gravity};
  JointDescription joint;
  joint.name = "joint";
  joint.type = type;
  model.addBody("body", 0, joint, {mass, com, {moments.x, 0, 0, moments.y, 0, moments.z}});
  return model;
}

Model freeBody() { return body("spherical", 1, {}, {1, 2, 3}, 0); }
Model heavyTop() { return body("spherical", 1, {0, 0, 1}, {1, 1, 0.5}, 9.81); }

Model fourBars(int squares) {
  Model model;
  model.name = "four_bars_" + std::to_string(squares);
  model.gravity = {0, -9.81, 0};
  const double I = 1.0 / 12;
  const Inertia<double> crank{1, {0, 0.5, 0}, {I, 0, 0, 0, 0, I}}, coupler{1, {0.5, 0, 0}, {0, 0, 0, I, 0, I}};
  int above = addBar(model, "crank0", 0, {0, 0, 1}, {}, crank);
  for (int k = 1; k <= squares; ++k) {
    // A coupler from the top of the previous crank, and a crank whose base is on the ground.
    const std::string n = std::to_string(k);
    addBar(model, "coupler" + n, above, {0, 0, 1}, {0, 1, 0}, coupler);
    above = addBar(model, "crank" + n, 0, {0, 0, 1}, {static_cast<double>(k), 0, 0}, crank);
    ConstraintDescription d = closeLoop("loop" + n, "coupler" + n + "_link", "crank" + n + "_link", {false, false, false, true, true, true});
    std::get<FrameConstraint>(d.relation).placement.p = {1, 0, 0};
    std::get<FrameConstraint>(d.relation).other_placement.p = {0, 1, 0};
    model.constraints.push_back(d);
  }
  return model;
}

Model fourBarsCrank(int squares) {
  Model model;
  model.name = "four_bars_crank";
  model.gravity = {0, -9.81, 0};
  const double cranks = squares + 1, couplers = squares;
  // Each crank has 1 kg and its centre of mass at half its length. The couplers translate with the cranks' ends and do not turn.
  Inertia<double> all{cranks, {0, 0.5, 0}, {cranks / 12, 0, 0, 0, 0, cranks / 12}};
  all = all + Inertia<double>{couplers, {0, 1, 0}, {}};
  addBar(model, "crank", 0, {0, 0, 1}, {}, all);
  return model;
}

}  // namespace dyn::tool
