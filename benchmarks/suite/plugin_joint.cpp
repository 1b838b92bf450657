// SPDX-License-Identifier: BSD-2-Clause
// Measures the cost of a plugin joint whose author wrote only the pose map, compared with a revolute joint. Eight joints of either type are added
// at the end of the robot's tree.
#include "suite/suite.hpp"

#include <dyn/error.hpp>
#include <dyn/parsers/urdf.hpp>

#include <filesystem>

namespace dyn::suite {

namespace {

Model withJoints(const Model& robot, const std::string& type) {
  Model model = robot;
  const int last = static_cast<int>(robot.bodies.size()) - 1;
  for (int i = 0; i < 8; ++i) {
    JointDescription joint;
    joint.name = "extra" + std::to_string(i);
    joint.type = type;
    if (type == "revolute") joint.parameters["axis"] = std::vector<double>{0, 0, 1};
    if (type == "cam_follower") joint.parameters["h"] = std::vector<double>{0.05};
    joint.placement.p = {0, 0, 0.1};
    model.addBody("extra body" + std::to_string(i), last - 4 * i, joint, {0.1, {0, 0, 0.01}, {1e-4, 0, 0, 1e-4, 0, 1e-4}});
  }
  return model;
}

}  // namespace

void addPluginJoint() {
  const JointRegistry registry = JointRegistry::standard();
  bool there = false;
  for (const JointType* type : registry.jointTypes()) there = there || std::string(type->info().name) == "cam_follower";
  if (!there) {
    ::benchmark::AddCustomContext("without", "the joint cam_follower of plugins/examples: its folder is not in DYN_PLUGIN_PATH");
    return;
  }
  const std::string talos = sharedModels() + "/talos.urdf";
  const std::string file = std::filesystem::exists(talos) ? talos : DYN_SOURCE_DIR "/models/biped.urdf";
  const Model robot = urdf::load(file, {.root = "free_flyer"});
  for (const char* type : {"revolute", "cam_follower"})
    addSingle(robot.name + "+8_" + type, std::make_shared<const Subject>(compile(withJoints(robot, type), registry)), true);
}

}  // namespace dyn::suite
