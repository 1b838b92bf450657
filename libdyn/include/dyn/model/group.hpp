// SPDX-License-Identifier: BSD-2-Clause
// Names for parts and states of a robot, as planners use them: groups of joints, end effectors, named configurations.
#pragma once

#include <dyn/error.hpp>

#include <string>
#include <vector>

namespace dyn {

/// The joints on the way from one body to another.
struct Chain {
  std::string base{},  ///< name of a body that carries the other; its own joint does not belong to the chain
      tip{};           ///< name of the last body; its joint belongs to the chain
};

/// A named part of a robot. Model::jointsOf() lists its joints.
struct GroupDescription {
  std::string name{};                 ///< unique among the model's groups
  std::vector<std::string> bodies{},  ///< names of bodies; their joints belong to the group
      joints{};                       ///< names of joints
  std::vector<Chain> chains{};        ///< all joints of each belong to the group
  std::vector<std::string> groups{};  ///< names of other groups, which belong to this one as a whole
  Where where{};                      ///< where the description was read, for messages
};

/// A hand or a tool.
struct EndEffectorDescription {
  std::string name{},  ///< unique among the model's end effectors
      group{},         ///< name of the group that is the end effector
      body{},          ///< name of the body that carries it
      parent_group{};  ///< name of the group that moves it; empty: not said
  Where where{};       ///< where the description was read, for messages
};

/// The joint between a robot and its surroundings, as a planner sees it. It does not move the model: the root joint does.
struct VirtualJointDescription {
  std::string name{},  ///< the planner's name of the joint
      type{},          ///< the type of joint that the planner expects, such as "free_flyer"
      frame{},         ///< name of a frame of the surroundings, which the model need not have
      body{};          ///< name of the body that the joint carries
  Where where{};       ///< where the description was read, for messages
};

/// Coordinates of one joint.
struct JointState {
  std::string joint{};      ///< the joint's name
  std::vector<double> q{},  ///< nq coordinates of the joint's type; empty: neutral
      v{};                  ///< nv velocities; empty: at rest
};

/// A named state of the robot. Joints that it does not name are neutral and at rest.
struct ConfigurationDescription {
  std::string name{},                ///< such as "home"; several groups may have a state of one name
      group{};                       ///< name of the group that the state belongs to; empty: the whole robot
  std::vector<JointState> joints{};  ///< the joints that it sets
  Where where{};                     ///< where the description was read, for messages
};

}  // namespace dyn
