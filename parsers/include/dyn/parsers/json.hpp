// SPDX-License-Identifier: BSD-2-Clause
// libdyn's own format, NAME.dyn.json: all of a Model, with nothing lost. Numbers read back to the same bits.
#pragma once

#include <dyn/model/model.hpp>

#include <cstdint>
#include <string>

namespace dyn::json {

/// The version of the format that save() writes. load() reads it and all before it.
inline constexpr int format_version = 1;
/// The most that is read of a file [bytes].
inline constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 30;

/// Reads a model from a file. Throws Error(file); Error(syntax) with the line of malformed JSON. Members that are unknown, missing, there twice or of
/// the wrong kind, and texts with control characters, are Error(syntax) with their place, such as bodies[2].joint.type. Names that are not there are
/// Error(model).
DYN_API Model load(const std::string& path);
/// Does the same for a text, which messages call `name`.
DYN_API Model parse(const std::string& text, const std::string& name);

/// Returns a model as text. Deterministic. Members that have their usual values are left out. Throws Error(model) for a model whose bodies[0] is not
/// the world, whose indices are out of range, or whose texts are no UTF-8 or have control characters.
DYN_API std::string write(const Model& model);
/// Replaces a file by that text, as a whole. Throws as write() and replaceFile().
DYN_API void save(const Model& model, const std::string& path);

}  // namespace dyn::json
