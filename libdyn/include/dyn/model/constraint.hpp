// SPDX-License-Identifier: BSD-2-Clause
// Constraints of a mechanism in addition to its joints: contacts, closed loops, joints coupled to others, and locked joints.
#pragma once

#include <dyn/model/joint_description.hpp>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

/// Axes of a constraint between two frames. Its rows, forces and free directions are along
///   LOCAL                the axes of its own frame
///   OTHER                the axes of the other frame, or of the world if that is the universe
///   LOCAL_WORLD_ALIGNED  the axes of the world
enum class ConstraintAxes { LOCAL, OTHER, LOCAL_WORLD_ALIGNED };

/// Feedback that reduces constraint violations: the rows' acceleration shall be -velocity * (J v) - position * error (Baumgarte 1972).
/// Zero gains mean no feedback. Critical damping with time constant T has position = 1 / T^2, velocity = 2 / T.
struct Baumgarte {
  double position = 0;  ///< gain on the position error [1/s^2]
  double velocity = 0;  ///< gain on the velocity [1/s]
};

/// A constraint between two frames: seen from the body of `other`, the origin and axes of `frame` may move in the free directions only. The
/// constrained velocity is that of the origin of `frame` relative to the point of the other body at the same place.
struct FrameConstraint {
  std::string frame{},                          ///< name of a body or frame
      other = "universe";                       ///< name of another one, on another body
  SE3<double> placement{},                      ///< pose of the constraint's own frame in `frame`
      other_placement{};                        ///< pose of its other frame in `other`
  std::array<bool, 6> free{};                   ///< free translations along x, y, z, and rotations about x, y, z; at least one is not free
  ConstraintAxes axes = ConstraintAxes::LOCAL;  ///< the axes of rows, forces and free directions
  /// Whether the two frames shall coincide in the directions that are not free. A contact that holds a point wherever it has touched has no target,
  /// and so no position error.
  bool has_target = false;
};

/// The coordinate of `joint` is a function of another joint's. A force maintains the relation; the coordinate stays in the model.
struct JointCoupling {
  std::string joint{};  ///< name of the dependent joint, of one degree of freedom
  Coupling coupling{};  ///< the relation and the joint that it depends on
};

/// Forces hold a joint. Its coordinates stay in the model.
struct JointLock {
  std::string joint{};                  ///< the joint's name
  std::vector<double> configuration{};  ///< the joint's nq numbers; empty: holds it wherever it is
};

/// A constraint of a mechanism: its name, its relation and its feedback.
struct ConstraintDescription {
  std::string name{};                                                  ///< unique within a set
  std::variant<FrameConstraint, JointCoupling, JointLock> relation{};  ///< what is constrained
  Baumgarte baumgarte{};                                               ///< feedback that reduces violations
  Where where{};                                                       ///< where the description was read, for messages
};

/// Describes a point of a robot that rests on the world or on another body: three forces. The constraint has the frame's name.
DYN_API ConstraintDescription pointContact(const std::string& frame, const std::string& other = "universe");
/// Describes a foot that stands flat or a hand that holds: three forces, three moments. The constraint has the frame's name.
DYN_API ConstraintDescription frameContact(const std::string& frame, const std::string& other = "universe");
/// Describes a closed loop: frames of two bodies coincide in the directions that are not free, in axes of `other`.
DYN_API ConstraintDescription closeLoop(const std::string& name, const std::string& frame, const std::string& other,
                                        const std::array<bool, 6>& free = {});
/// Describe a coupled joint, and a locked joint. The constraint has the joint's name.
/// @{
DYN_API ConstraintDescription coupleJoint(const std::string& joint, const Coupling& coupling);
DYN_API ConstraintDescription lockJoint(const std::string& joint, const std::vector<double>& configuration = {});
/// @}

}  // namespace dyn
