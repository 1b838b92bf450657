// SPDX-License-Identifier: BSD-2-Clause
// The numbers of a description that a compiled model can change: CompactModel::withNumbers().
#pragma once

#include <dyn/spatial/inertia.hpp>

#include <optional>
#include <string>
#include <vector>

namespace dyn {

/// The inertia of a described body. Bodies that are welded to others have one, too.
struct BodyInertia {
  std::string body{};         ///< its name
  Inertia<double> inertia{};  ///< in the body's frame
};

/// The place of a described joint. Rigid joints have one, too.
struct JointPlacement {
  std::string joint{};      ///< its name
  SE3<double> placement{};  ///< pose of the joint at its zero in the parent body's frame
};

/// Numbers of a joint that moves.
struct JointNumbers {
  std::string joint{};           ///< its name
  std::vector<double> values{};  ///< one for each of its degrees of freedom
};

/// Some numbers of a description, with the names, units and frames of Model. If a name occurs twice, the last entry counts.
struct ModelNumbers {
  std::optional<Vec3<double>> gravity{};     ///< in the world [m/s^2]; empty: unchanged
  std::vector<BodyInertia> inertias{};       ///< of bodies
  std::vector<JointPlacement> placements{};  ///< of joints
  std::vector<JointNumbers> damping{},       ///< viscous [N m s/rad or N s/m]
      friction{},                            ///< Coulomb [N m or N]
      armature{};                            ///< rotor inertia [kg m^2 or kg]
};

}  // namespace dyn
