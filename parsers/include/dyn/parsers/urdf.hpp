// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from URDF. Errors that urdfdom lets pass are reported, with file and line.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::urdf {

enum class Mimic { coupled, independent };
enum class Order { name, file };
enum class Continuous { unit_circle, angle };
enum class Inertias { physical, any };

struct Options {
  std::string root = "fixed";                       ///< joint type between world and root link, e.g. "free_flyer"
  Mimic mimic = Mimic::coupled;                     ///< couple mimic joints to their masters, or leave them independent
  Order order = Order::name;                        ///< siblings sorted by joint name (as in urdfdom and Pinocchio) or as in the file
  Continuous continuous = Continuous::unit_circle;  ///< q = (cos, sin), or one unbounded angle
  Inertias inertias = Inertias::physical;           ///< refuse inertias that are not positive semi-definite, or note them
};

/// Reads a robot. Every link becomes a body; fixed joints stay joints of type "fixed". The root link's joint is called "root_joint", with "_"
/// appended until the file has no joint of that name. Throws Error(file | syntax | model).
DYN_API Model load(const std::string& path, const Options& options = {});
/// The same from a text, which messages call `name`. Throws Error(syntax | model).
DYN_API Model parse(const std::string& text, const std::string& name, const Options& options = {});

/// Returns all errors of a file, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const Options& options = {});

}  // namespace dyn::urdf
