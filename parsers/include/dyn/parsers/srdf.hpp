// What an SRDF file (MoveIt's companion of a URDF) says about collisions.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::srdf {

/// Adds the file's <disable_collisions link1 link2 reason/> to model.disabled_collisions. Links that the model does not have are a note in
/// model.notes; everything else in the file is ignored. Throws Error(file | syntax); then the model is as it was.
DYN_API void load(const std::string& path, Model& model);
/// The same from text; `name` stands for the file in messages.
DYN_API void parse(const std::string& text, const std::string& name, Model& model);

/// An SRDF with these pairs and nothing else.
DYN_API std::string text(const std::string& robot, const std::vector<DisabledCollision>& disabled);
/// The same as a file: written to a temporary beside it and renamed. Throws Error(file).
DYN_API void write(const std::string& path, const std::string& robot, const std::vector<DisabledCollision>& disabled);

}  // namespace dyn::srdf
