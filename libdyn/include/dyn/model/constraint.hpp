// What a mechanism may not do beside what its joints say: contacts, closed loops, joints that are tied to others or held.
#pragma once

#include <dyn/model/joint_description.hpp>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

/// Axes in which a constraint between two frames has its rows, forces and free directions:
///   LOCAL                those of the frame that it is on
///   OTHER                those of the other frame; of the world where the other is the universe
///   LOCAL_WORLD_ALIGNED  the world's
enum class ConstraintAxes { LOCAL, OTHER, LOCAL_WORLD_ALIGNED };

/// Feedback that brings a violated constraint back: its acceleration is to be -velocity * (J v) - position * error (Baumgarte 1972).
/// Zero: none. Critical damping with time constant T: position = 1 / T^2, velocity = 2 / T.
struct Baumgarte {
  double position = 0;  ///< [1/s^2]
  double velocity = 0;  ///< [1/s]
};

/// Between two frames: the origin and the axes of `frame` may not move as seen from the body of `other`, but in the directions that are
/// free. The velocity is that of the origin of `frame` relative to the point of the other body that is there.
struct FrameConstraint {
  std::string frame{}, other = "universe";     ///< bodies or frames
  SE3<double> placement{}, other_placement{};  ///< of the constraint's frames in these
  std::array<bool, 6> free{};                  ///< translations along x, y, z, rotations about x, y, z
  ConstraintAxes axes = ConstraintAxes::LOCAL;
  /// Whether the two frames are meant to coincide (in the directions that are not free). A contact that holds its point wherever it has
  /// touched has no such place, and so no error of position.
  bool has_target = false;
};

/// The coordinate of `joint` is a function of another's, kept by a force in place of taking the coordinate out of the model.
struct JointCoupling {
  std::string joint{};
  Coupling coupling{};
};

/// A joint that is held.
struct JointLock {
  std::string joint{};
  std::vector<double> configuration{};  ///< where; empty: wherever it is
};

struct ConstraintDescription {
  std::string name{};  ///< for messages; unique within a set
  std::variant<FrameConstraint, JointCoupling, JointLock> relation{};
  Baumgarte baumgarte{};
  Where where{};
};

/// A point of a robot that rests on the world or on another body: three forces. Named as the frame.
DYN_API ConstraintDescription pointContact(const std::string& frame, const std::string& other = "universe");
/// A foot that stands flat, a hand that holds: three forces, three moments.
DYN_API ConstraintDescription frameContact(const std::string& frame, const std::string& other = "universe");
/// Frames of two bodies that coincide in the directions that are not free, which are those of `other`.
DYN_API ConstraintDescription closeLoop(const std::string& name, const std::string& frame, const std::string& other,
                                        const std::array<bool, 6>& free = {});
DYN_API ConstraintDescription coupleJoint(const std::string& joint, const Coupling& coupling);
DYN_API ConstraintDescription lockJoint(const std::string& joint, const std::vector<double>& configuration = {});

}  // namespace dyn
