// SPDX-License-Identifier: BSD-2-Clause
// One door to all formats of model files.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/options.hpp>
#include <dyn/parsers/urdf.hpp>

#include <string>
#include <vector>

namespace dyn {

/// A format of model files.
struct ModelFormat {
  std::string name{};                  ///< what `format` and the option --format call it
  std::vector<std::string> endings{};  ///< endings of the files' names, such as ".urdf"
  std::string missing{};               ///< why this libdyn cannot read it; empty if it can
};

/// Returns all formats, with those that this libdyn was built without.
DYN_API std::vector<ModelFormat> modelFormats();

/// Reads a robot from a file. `format` is the name of a format; if it is empty, the file's ending tells the format, and its content does where the
/// ending does not. Throws Error(file | syntax | model) as the format's own function, Error(syntax) for content of no known format, and
/// Error(argument) for a format that does not exist or that this libdyn was built without, and for a root joint that does not apply.
DYN_API Model load(const std::string& path, const LoadOptions& options = {}, const std::string& format = {});

/// Returns all errors of a file that its format's reader finds in one pass, of which load() throws the first; empty if the file loads.
DYN_API std::vector<Error> check(const std::string& path, const LoadOptions& options = {}, const std::string& format = {});

}  // namespace dyn
