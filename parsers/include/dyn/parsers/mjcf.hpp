// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from MJCF, MuJoCo's format, and writes them. q has the numbers of MuJoCo's qpos, in the same order, but quaternions are x, y, z, w.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>
#include <dyn/parsers/written.hpp>

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

/// Returns a model as MJCF. Joints become free, ball, slide and hinge; several on one body where libdyn has bodies without mass between them.
/// Dependent joints become joints tied by an equality. Frames become sites, named states keyframes, bodies without collision checks excludes. Numbers
/// read back to the same bits, rotations (as quaternions) to the last digit. Deterministic. O(n). Throws Error(model) for types of joints that are no
/// series of MuJoCo's, for bodies that are nested deeper than 96, for numbers that are not finite, except limits, and for names and indices that do
/// not exist.
DYN_API Written write(const Model& model);
/// Replaces a file by that text, as a whole; returns what it cannot say. Throws as write() and replaceFile().
DYN_API std::vector<std::string> save(const Model& model, const std::string& path);

}  // namespace dyn::mjcf
