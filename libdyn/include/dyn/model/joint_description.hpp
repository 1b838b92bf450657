// SPDX-License-Identifier: BSD-2-Clause
// Description of a joint: the name of its type, parameters, limits, dissipation, and the joint that it depends on.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/se3.hpp>

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

struct JointDescription;

/// Value of a parameter of a joint or coupling: numbers, a text, or (for joints made of joints) a list of joints.
using ParameterValue = std::variant<std::vector<double>, std::string, std::vector<JointDescription>>;
/// Values of parameters by name.
using Parameters = std::map<std::string, ParameterValue>;

// All members of descriptions and options have initializers, so that designated initializers may leave members out without a warning.

/// A relation that makes a joint's coordinate a function of another joint's: a coupling type of a plugin, with its parameters.
struct Coupling {
  std::string type{};       ///< e.g. "mimic"; empty: the joint is independent
  std::string master{};     ///< name of the joint that this one depends on
  Parameters parameters{};  ///< as the coupling type defines them
};

/// Limits of one joint: one entry for each coordinate (position) or degree of freedom (all others). Empty means unlimited. compile() throws
/// Error(size) for another number of entries, and Error(model) for NaN or a lower limit above the upper one.
struct JointLimits {
  std::vector<double> lower{},     ///< lowest position [rad or m]
      upper{};                     ///< highest position [rad or m]
  std::vector<double> velocity{};  ///< largest speed [rad/s or m/s]
  std::vector<double> effort{};    ///< largest force [N m or N]
  /// For planners and controllers; CompactModel does not have them.
  std::vector<double> acceleration{},  ///< largest acceleration [rad/s^2 or m/s^2]
      deceleration{},                  ///< largest deceleration, if it differs
      jerk{};                          ///< largest rate of change of the acceleration [rad/s^3 or m/s^3]
};

/// A joint by type name and parameters. Only the plugin knows what these names mean.
struct JointDescription {
  std::string name{};              ///< unique among the model's joints
  std::string type = "fixed";      ///< the name of a joint type in the registry
  Parameters parameters{};         ///< as the type defines them
  SE3<double> placement{};         ///< pose of the joint at its zero in the parent body's frame
  JointLimits limits{};            ///< none by default
  std::vector<double> damping{};   ///< viscous [N m s/rad or N s/m], one value for each degree of freedom; empty: none
  std::vector<double> friction{};  ///< Coulomb [N m or N], likewise
  std::vector<double> armature{};  ///< rotor inertia seen by the joint [kg m^2 or kg], likewise
  Coupling coupling{};             ///< the joint on which this one depends, if any
  /// The joint is rigid only because reduce() holds it. Collision pairs are chosen as if it could move.
  bool held = false;
  Where where{};  ///< where the description was read, for messages
};

}  // namespace dyn
