// SPDX-License-Identifier: BSD-2-Clause
// How model files are read, whatever their format.
#pragma once

#include <string>

namespace dyn {

/// Mimic joints follow their masters, or move on their own.
enum class Mimic { coupled, independent };
/// Siblings are sorted by joint name, as in urdfdom and Pinocchio, or stay in the order of the file.
enum class Order { name, file };
/// A continuous joint has q = (cos, sin), or one unbounded angle.
enum class Continuous { unit_circle, angle };
/// Inertias that are not positive semi-definite are errors, or are noted and loaded. Links that fixed joints hold together are judged as one body.
enum class Inertias { physical, any };
/// Files of a version of their format that is newer than libdyn knows are refused, or are read as far as they are understood.
enum class Versions { known, any };

/// How a model file is read.
struct LoadOptions {
  std::string root = "fixed";                       ///< joint type between world and root link, for example "free_flyer"
  Mimic mimic = Mimic::coupled;                     ///< treatment of mimic joints
  Order order = Order::name;                        ///< order of siblings
  Continuous continuous = Continuous::unit_circle;  ///< coordinates of continuous joints
  Inertias inertias = Inertias::physical;           ///< treatment of inertias that no body has
  Versions versions = Versions::known;              ///< treatment of files that are newer than libdyn
};

}  // namespace dyn
