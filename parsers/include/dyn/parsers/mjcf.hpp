// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from MJCF, MuJoCo's format. q has the numbers of MuJoCo's qpos, in the same order, but quaternions are x, y, z, w.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>

#include <string>
#include <vector>

namespace dyn::mjcf {

/// Reads a robot. Every `<body>` becomes a body, whose frame is MuJoCo's. Joints of one body become a chain of bodies without mass, and so does a
/// joint that is not at the body's origin. A root joint other than "fixed" goes to the only body of the world, if that body has no joint. The options
/// mimic, order and continuous have no effect: qpos decides. Throws Error(file | syntax | model), and Error(argument) for a root joint that cannot be
/// added.
DYN_API Model load(const std::string& path, const LoadOptions& options = {});
/// Does the same for a text, which messages call `name`. Included files are searched in the folder of `name`.
DYN_API Model parse(const std::string& text, const std::string& name, const LoadOptions& options = {});

/// Returns all errors of a file, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const LoadOptions& options = {});

}  // namespace dyn::mjcf
