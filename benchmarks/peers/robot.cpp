// SPDX-License-Identifier: BSD-2-Clause
#include "peers/robot.hpp"

#include "compile/compact_impl.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <random>

namespace dyn::benchmark::peers {

namespace {

Model readUrdf(const std::string& file, bool floating) {
  urdf::Options options;
  options.root = floating ? "free_flyer" : "fixed";
  options.mimic = urdf::Mimic::independent;
  options.continuous = urdf::Continuous::angle;
  options.inertias = urdf::Inertias::any;
  return urdf::load(file, options);
}

CompactModel compileRobot(const Model& description) {
  CompileOptions options;
  options.dissipation = options.armature = false;
  return compile(description, JointRegistry::standard(), options);
}

}  // namespace

Robot readRobot(const std::string& file, bool floating) {
  const auto description = std::make_shared<const Model>(readUrdf(file, floating));
  const auto model = std::make_shared<const CompactModel>(compileRobot(*description));
  const CompactImpl& m = model->impl();
  Robot robot{m.name, floating, 0, {}, m.gravity, model, description};
  robot.links.resize(static_cast<std::size_t>(m.bodies()));
  for (std::size_t i = 1; i < robot.links.size(); ++i) {
    const BodyIndex& x = m.index[i];
    const BodyConstants<double>& c = m.constants[i];
    Link& link = robot.links[i];
    link.parent = x.parent;
    link.placement = c.placement;
    link.inertia = {c.mass, c.com, c.rotational};
    const Shape shape = m.batches[static_cast<std::size_t>(x.batch)].shape;
    if (shape == Shape::free && i == 1 && floating) {
      link.motion = Motion::floating;
      continue;
    }
    if (shape != Shape::revolute && shape != Shape::prismatic)
      throw Error(ErrorCode::argument, "the peers are compared on robots of one-axis joints",
                  {file, 0, m.joints[static_cast<std::size_t>(x.joint)].name});
    link.motion = shape == Shape::revolute ? Motion::revolute : Motion::prismatic;
    link.joint = robot.joints++;
  }
  return robot;
}

std::vector<State> randomStates(const Robot& robot, int count, bool still) {
  std::mt19937_64 engine(7);
  std::uniform_real_distribution<double> one(-1, 1);
  std::vector<State> states(static_cast<std::size_t>(count));
  for (State& s : states) {
    for (std::vector<double>* x : {&s.q, &s.v, &s.a})
      for (int j = 0; j < robot.joints; ++j) x->push_back(still && x == &s.v ? 0.0 : one(engine));
    if (still || !robot.floating) continue;
    for (int k = 0; k < 3; ++k) s.base_q[k] = one(engine);
    double norm = 0;
    for (int k = 3; k < 7; ++k) {
      s.base_q[k] = one(engine);
      norm += s.base_q[k] * s.base_q[k];
    }
    for (int k = 3; k < 7; ++k) s.base_q[k] /= std::sqrt(norm);
    for (int k = 0; k < 6; ++k) {
      s.base_v[k] = one(engine);
      s.base_a[k] = one(engine);
    }
  }
  return states;
}

}  // namespace dyn::benchmark::peers
