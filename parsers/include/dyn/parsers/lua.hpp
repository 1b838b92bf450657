// SPDX-License-Identifier: BSD-2-Clause
// Reads RBDL's Lua models. The script runs in a sandbox: it cannot reach files, the system, the clock or random numbers, and the instructions that it
// executes and the memory that it takes are counted and limited.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>

#include <string>
#include <vector>

namespace dyn::lua {

/// Reads a robot. Every entry of `frames` becomes a body; `points`, `local_frames` and `markers` become frames, `visuals` volumes, and the loops of
/// a file's only constraint set constraints of the model. The option `root` is the type of the joint of the only body on ROOT if that joint is fixed.
/// Throws Error(file), Error(syntax) with the line for a script that fails or exceeds a limit, Error(model) with the line of the table that is
/// wrong, and Error(argument) for a root joint that does not apply.
DYN_API Model load(const std::string& path, const LoadOptions& options = {});
/// Does the same for a text, which messages call `name`.
DYN_API Model parse(const std::string& text, const std::string& name, const LoadOptions& options = {});

/// A named set of constraints, such as a phase of a motion.
struct NamedConstraints {
  std::string name{};                                ///< the set's name
  std::vector<ConstraintDescription> constraints{};  ///< its contacts and loops, in the file's order
};

/// Returns the file's constraint sets by name, for ConstraintSet(model, descriptions). Throws as load().
DYN_API std::vector<NamedConstraints> constraintSets(const std::string& path);
/// Does the same for a text, which messages call `name`.
DYN_API std::vector<NamedConstraints> parseConstraintSets(const std::string& text, const std::string& name);

}  // namespace dyn::lua
