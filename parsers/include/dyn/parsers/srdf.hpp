// SPDX-License-Identifier: BSD-2-Clause
// Reads and writes the pairs of links in SRDF files (MoveIt's companion of a URDF) that are not checked for collision.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::srdf {

/// Adds the file's `disable_collisions` elements to model.disabled_collisions. Adds a note to model.notes for each link that the model
/// does not have. Ignores everything else in the file. Throws Error(file | syntax) and then leaves the model as it was.
DYN_API void load(const std::string& path, Model& model);
/// Does the same for a text, which messages call `name`. Throws Error(syntax).
DYN_API void parse(const std::string& text, const std::string& name, Model& model);

/// Returns the text of an SRDF with these pairs and nothing else.
DYN_API std::string text(const std::string& robot, const std::vector<DisabledCollision>& disabled);
/// Writes that text to a file: first to a temporary beside it, which is then renamed. Throws Error(file).
DYN_API void write(const std::string& path, const std::string& robot, const std::vector<DisabledCollision>& disabled);

}  // namespace dyn::srdf
