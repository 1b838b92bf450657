// SPDX-License-Identifier: BSD-2-Clause
// The description of a robot: bodies, the joint that carries each body, frames. Parsers and builder calls write it, compile() reads it.
#pragma once

#include <dyn/model/constraint.hpp>
#include <dyn/model/device.hpp>
#include <dyn/model/geometry_description.hpp>
#include <dyn/model/group.hpp>
#include <dyn/spatial/inertia.hpp>

#include <string>
#include <vector>

namespace dyn {

/// A body and the joint that carries it. The body's frame is the joint's frame after the joint's motion.
struct BodyDescription {
  std::string name{};         ///< unique among the model's bodies and frames
  int parent = 0;             ///< index of the parent body, smaller than the body's own; 0 is the world
  JointDescription joint{};   ///< connects the parent to the body
  Inertia<double> inertia{};  ///< in the body's frame
  Where where{};              ///< where the description was read, for messages
};

/// A named frame fixed to a body.
struct FrameDescription {
  std::string name{};       ///< unique among the model's bodies and frames
  int body = 0;             ///< index in Model::bodies
  SE3<double> placement{};  ///< pose in the body's frame
};

/// The description of a robot, which compile() turns into a CompactModel. Parents come before their children in `bodies`. bodies[0] is the world,
/// called "universe".
struct DYN_API Model {
  std::string name;                                      ///< the robot's name
  Vec3<double> gravity{0, 0, -9.81};                     ///< in the world [m/s^2]
  std::vector<BodyDescription> bodies;                   ///< the world and all bodies
  std::vector<FrameDescription> frames;                  ///< in addition to the frame of each body
  std::vector<ConstraintDescription> constraints;        ///< of the mechanism itself: closed loops, gears
  std::vector<GeometryDescription> geometries;           ///< volumes on bodies and in the world
  std::vector<DisabledCollision> disabled_collisions;    ///< pairs that compileGeometry() leaves out
  std::vector<GroupDescription> groups;                  ///< named parts
  std::vector<EndEffectorDescription> end_effectors;     ///< hands and tools
  std::vector<VirtualJointDescription> virtual_joints;   ///< how planners see the root joints
  std::vector<std::string> passive_joints;               ///< names of joints that no motor moves
  std::vector<ConfigurationDescription> configurations;  ///< named states; namedConfiguration() returns their q
  std::vector<DeviceDescription> devices;                ///< actuators, tendons and sensors, which are kept and not used
  std::vector<std::string> notes;                        ///< what a parser ignored or found odd, each once

  /// Makes a model that has only the world.
  Model();

  /// Appends a body; returns its index. Throws Error(argument) for a parent that does not exist, Error(model) if `bodies` is empty. compile()
  /// finds names that are used twice.
  int addBody(const std::string& body, int parent, JointDescription joint, const Inertia<double>& inertia = {});
  /// Appends a frame at `placement` in the body's frame; returns its index in `frames`. Throws Error(argument) for a body that does not exist.
  int addFrame(const std::string& frame, int body, const SE3<double>& placement);
  /// Appends a volume for collision; returns its index in `geometries`. Throws as addFrame.
  int addGeometry(const std::string& geometry, int body, const SE3<double>& placement, GeometryShape shape);
  /// Return the index of the body with that name, and of the body carried by the joint with that name; -1 if there is none. O(n).
  /// @{
  int findBody(const std::string& body) const;
  int findJoint(const std::string& joint) const;
  /// @}
  /// Returns the index of the collision geometry of that name; -1 if there is none. O(geometries).
  int findGeometry(const std::string& geometry) const;
  /// Returns the names of the joints of a group, of its chains and of its subgroups, in the order of `bodies`. Throws Error(argument) for a group
  /// that does not exist, and Error(model) if it names a body, joint or group that does not. O(n + the groups and the lengths of
  /// their chains).
  std::vector<std::string> jointsOf(const std::string& group) const;
};

}  // namespace dyn
