// SPDX-License-Identifier: BSD-2-Clause
// How model files are read, whatever their format.
#pragma once

#include <cstdint>
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

/// Files that a model file includes, and meshes whose mass it needs, lie in the model's folder or below it, or may lie anywhere.
enum class Files { beside, anywhere };

/// The most that is read of a model file [bytes]; .dyn.json has a limit of its own.
inline constexpr std::uintmax_t largest_model_file = std::uintmax_t{64} << 20;

/// How a model file is read.
struct LoadOptions {
  std::string root = "fixed";                       ///< joint type between world and root link, for example "free_flyer"
  Mimic mimic = Mimic::coupled;                     ///< treatment of mimic joints
  Order order = Order::name;                        ///< order of siblings
  Continuous continuous = Continuous::unit_circle;  ///< coordinates of continuous joints
  Inertias inertias = Inertias::physical;           ///< treatment of inertias that no body has
  Files files = Files::beside;                      ///< where files may lie that the model file names
  Versions versions = Versions::known;              ///< treatment of files that are newer than libdyn
};

}  // namespace dyn
