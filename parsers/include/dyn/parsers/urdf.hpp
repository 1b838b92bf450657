// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from URDF and writes them. Errors that urdfdom lets pass are reported, with file and line.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>
#include <dyn/parsers/written.hpp>

#include <string>
#include <vector>

namespace dyn::urdf {

using dyn::Continuous;
using dyn::Inertias;
using dyn::Mimic;
using dyn::Order;
using dyn::Versions;
using dyn::Written;
using Options = LoadOptions;  ///< how a URDF is read

/// Reads a robot. Every link becomes a body; fixed joints stay joints of type "fixed". The root link's joint is called "root_joint", with "_"
/// appended until the file has no joint of that name. Throws Error(file | syntax | model).
DYN_API Model load(const std::string& path, const Options& options = {});
/// Does the same for a text, which messages call `name`. Throws Error(syntax | model).
DYN_API Model parse(const std::string& text, const std::string& name, const Options& options = {});

/// Returns all errors of a file, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const Options& options = {});

/// Returns a model as URDF, with libdyn's extension for what other programs do not know: types of plugins, armatures, closed loops, gears. Numbers
/// read back to the same bits, rotations (as roll, pitch and yaw) to the last digit. A single body that is fixed to the world at the identity becomes
/// the root link; otherwise the world becomes a link "world". Frames become links on fixed joints. Deterministic. Throws Error(model) for numbers
/// that are not finite, except limits, and for indices out of range.
DYN_API Written write(const Model& model);
/// Replaces a file by that text, as a whole; returns what it cannot say. Throws as write() and replaceFile().
DYN_API std::vector<std::string> save(const Model& model, const std::string& path);

}  // namespace dyn::urdf
