// SPDX-License-Identifier: BSD-2-Clause
// Reads robots from URDF. Errors that urdfdom lets pass are reported, with file and line.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>

#include <string>
#include <vector>

namespace dyn::urdf {

using dyn::Continuous;
using dyn::Inertias;
using dyn::Mimic;
using dyn::Order;
using Options = LoadOptions;  ///< how a URDF is read

/// Reads a robot. Every link becomes a body; fixed joints stay joints of type "fixed". The root link's joint is called "root_joint", with "_"
/// appended until the file has no joint of that name. Throws Error(file | syntax | model).
DYN_API Model load(const std::string& path, const Options& options = {});
/// Does the same for a text, which messages call `name`. Throws Error(syntax | model).
DYN_API Model parse(const std::string& text, const std::string& name, const Options& options = {});

/// Returns all errors of a file, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const Options& options = {});

}  // namespace dyn::urdf
