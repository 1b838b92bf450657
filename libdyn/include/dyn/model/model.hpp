// The description of a robot: bodies, the joint that carries each, frames. Parsers and builder calls write it, compile() reads it.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/inertia.hpp>

#include <limits>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

struct JointDescription;

/// Value of a joint parameter: numbers, a text, or (for joints made of joints) a list of joints.
using ParameterValue = std::variant<std::vector<double>, std::string, std::vector<JointDescription>>;
using Parameters = std::map<std::string, ParameterValue>;

/// Limits of one joint, one entry a coordinate (position) or degree of freedom (the rest). Empty means unlimited.
struct JointLimits {
  std::vector<double> lower, upper;  ///< [rad or m]
  std::vector<double> velocity;      ///< [rad/s or m/s]
  std::vector<double> effort;        ///< [N m or N]
};

/// A relation that makes a joint's coordinate a function of another joint's: a coupling type of a plugin with its parameters.
struct Coupling {
  std::string type;    ///< e.g. "mimic"; empty: the joint is independent
  std::string master;  ///< name of the joint that leads
  Parameters parameters;
};

/// A joint by type name and parameters; what the names mean is known to the plugin alone.
struct JointDescription {
  std::string name;
  std::string type = "fixed";
  Parameters parameters;
  SE3<double> placement;  ///< pose of the joint at its zero in the parent body's frame
  JointLimits limits;
  std::vector<double> damping;   ///< viscous [N m s/rad or N s/m], a value a degree of freedom; empty: none
  std::vector<double> friction;  ///< Coulomb [N m or N]
  std::vector<double> armature;  ///< rotor inertia seen by the joint [kg m^2 or kg]
  Coupling coupling;
  Where where;  ///< where it was read, for messages
};

/// A body and the joint that carries it. The body's frame is the joint's frame after its motion.
struct BodyDescription {
  std::string name;
  int parent = 0;  ///< index of the parent body, smaller than the body's own; 0 is the universe
  JointDescription joint;
  Inertia<double> inertia;
  Where where;
};

/// A named frame fixed to a body.
struct FrameDescription {
  std::string name;
  int body = 0;
  SE3<double> placement;  ///< pose in the body's frame
};

/// Bodies in an order in which parents come first. bodies[0] is the universe.
struct DYN_API Model {
  std::string name;
  Vec3<double> gravity{0, 0, -9.81};  ///< in the world [m/s^2]
  std::vector<BodyDescription> bodies;
  std::vector<FrameDescription> frames;  ///< beside those that every body is
  std::vector<std::string> notes;        ///< what a parser ignored or found odd, once each

  Model();

  /// Appends a body; returns its index. Throws Error(argument) for a parent that does not exist.
  /// Names used twice are found by compile().
  int addBody(const std::string& body, int parent, JointDescription joint, const Inertia<double>& inertia = {});
  /// Appends a frame; returns its index in `frames`. Throws as addBody.
  int addFrame(const std::string& frame, int body, const SE3<double>& placement);
  /// Index of the body of that name, or of the body that the joint of that name carries; -1 if there is none.
  int findBody(const std::string& body) const;
  int findJoint(const std::string& joint) const;
};

}  // namespace dyn
