// SPDX-License-Identifier: BSD-2-Clause
// Settings of the whole model, by <compiler> and <option>.
#pragma once

#include "values.hpp"

#include <dyn/spatial/se3.hpp>

#include <string>

namespace dyn::mjcf {

/// The settings of all <compiler> and <option> elements. A later value of an attribute replaces an earlier one.
struct Settings {
  bool degrees = true;
  std::string eulerseq = "xyz";
  bool autolimits = true;
  enum class FromGeoms { never, always, if_missing } inertia_from_geoms = FromGeoms::if_missing;
  std::array<int, 2> inertia_groups{0, 5};
  bool balance_inertia = false;
  double least_mass = 0, least_inertia = 0;  ///< of each body [kg, kg m^2]
  double total_mass = -1;                    ///< of all bodies [kg]; negative: as they are
  std::string mesh_folder;                   ///< seen from the folder of the main file
  bool strip_path = false;
  bool discard_visual = false;
  bool exact_mesh_inertia = false;
  Vec3<double> gravity{0, 0, -9.81};

  /// Returns an angle of the file in radians.
  long double angle(long double given) const { return degrees ? given * (3.14159265358979323846264338327950288L / 180) : given; }
};

/// Reads the settings. Throws Error(syntax | model) for values that MuJoCo does not have, and for global coordinates.
Settings readSettings(const Source& source);

/// Returns the rotation of an element: quat (w, x, y, z), axisangle, xyaxes, zaxis or euler. The element's own spelling replaces that of its class.
/// Throws Error(syntax) for two spellings, and Error(model) for one without a direction.
Mat3<long double> rotationOf(const Values& values, const Settings& settings);
/// Returns the pose of an element: its pos and its rotation.
SE3<long double> poseOf(const Values& values, const Settings& settings);
/// Returns the smallest rotation that turns z into the direction of `axis`.
Mat3<long double> rotationToZ(const Vec3<long double>& axis);
/// Returns the rotation of angles about the axes that `sequence` names: small letters turn with the body, capital ones stay.
Mat3<long double> eulerRotation(const Vec3<long double>& angles, const std::string& sequence);

}  // namespace dyn::mjcf
