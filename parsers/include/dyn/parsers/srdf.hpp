// SPDX-License-Identifier: BSD-2-Clause
// Reads SRDF files, MoveIt's companions of URDFs: groups, named states, and pairs of links that are not checked for collision. Writes such pairs.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::srdf {

/// Adds to the model what the file says about it: groups, end effectors, virtual joints, passive joints, states of groups (Model::configurations) and
/// pairs of `disable_collisions`. A value of a continuous or planar joint becomes the cosine and sine of its angle. A virtual joint in groups and
/// states becomes the root joint for which it stands. Adds a note to model.notes for each name that the model does not have, for each kind of element
/// that is ignored, and where the root joint is of another type than the virtual joint. Names that the model does not have are left out of groups and
/// states. Throws Error(file | syntax), and Error(model) for two groups of one name and a state that sets a joint twice; the model is then as before.
DYN_API void load(const std::string& path, Model& model);
/// Does the same for a text, which messages call `name`. Throws Error(syntax | model).
DYN_API void parse(const std::string& text, const std::string& name, Model& model);

/// Returns the text of an SRDF with these pairs and nothing else.
DYN_API std::string text(const std::string& robot, const std::vector<DisabledCollision>& disabled);
/// Writes that text to a file: first to a temporary beside it, which is then renamed. Throws Error(file).
DYN_API void write(const std::string& path, const std::string& robot, const std::vector<DisabledCollision>& disabled);

}  // namespace dyn::srdf
