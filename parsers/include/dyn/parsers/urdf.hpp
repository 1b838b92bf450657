// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from URDF. Errors that urdfdom lets pass are reported, with file and line.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::urdf {

/// Mimic joints follow their masters, or move on their own.
enum class Mimic { coupled, independent };
/// Siblings are sorted by joint name, as in urdfdom and Pinocchio, or stay in the order of the file.
enum class Order { name, file };
/// A continuous joint has q = (cos, sin), or one unbounded angle.
enum class Continuous { unit_circle, angle };
/// Inertias that are not positive semi-definite are errors, or are noted and loaded.
enum class Inertias { physical, any };

/// How a URDF is read.
struct Options {
  std::string root = "fixed";                       ///< joint type between world and root link, for example "free_flyer"
  Mimic mimic = Mimic::coupled;                     ///< treatment of mimic joints
  Order order = Order::name;                        ///< order of siblings
  Continuous continuous = Continuous::unit_circle;  ///< coordinates of continuous joints
  Inertias inertias = Inertias::physical;           ///< treatment of inertias that no body has
};

/// Reads a robot. Every link becomes a body; fixed joints stay joints of type "fixed". The root link's joint is called "root_joint", with "_"
/// appended until the file has no joint of that name. Throws Error(file | syntax | model).
DYN_API Model load(const std::string& path, const Options& options = {});
/// Does the same for a text, which messages call `name`. Throws Error(syntax | model).
DYN_API Model parse(const std::string& text, const std::string& name, const Options& options = {});

/// Returns all errors of a file, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const Options& options = {});

}  // namespace dyn::urdf
