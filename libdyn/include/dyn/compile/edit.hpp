// SPDX-License-Identifier: BSD-2-Clause
// Functions that make new models from old ones: they hold joints, or join models. They take and return descriptions and keep what they do not
// change.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn/model/model.hpp>

namespace dyn {

/// A joint to hold, and its coordinates there.
struct LockedJoint {
  std::string joint;      ///< its name
  std::vector<double> q;  ///< nq coordinates; empty means neutral
};

/// Returns the model with these joints rigid. They become joints of type "fixed" at the pose at which they are held. They keep their names, bodies,
/// frames and inertias. They lose limits, dissipation and armature, which rigid joints do not have.
/// Joints, and parts of joints, that depend on a held joint are held where their coupling puts them, unless `lock` names them itself. If `lock`
/// names a dependent joint, its q holds it; if that q is empty, its coupling does, with the master at its own q in `lock` or at neutral. Dependent
/// parts of a named joint are always held by their couplings, and q has only the numbers of its other parts.
/// Throws Error(model) for a joint that does not exist or is named twice, Error(size) for a q of the wrong size, Error(argument) for an empty name.
DYN_API Model reduce(const Model& model, const JointRegistry& registry, const std::vector<LockedJoint>& lock);

/// Returns the model with all joints rigid at neutral, except those named in `keep` and the joints on which these depend. Throws Error(model) for a
/// name in `keep` that does not exist.
DYN_API Model keepOnly(const Model& model, const JointRegistry& registry, const std::vector<std::string>& keep);

/// Returns `model` with a copy of `other` that the body or frame called `at` carries, at `placement` in it. Names of the copy get `prefix`.
/// Gravity, name and virtual joints are those of `model`. Throws Error(model) if `at` does not exist or a name would be used twice.
DYN_API Model append(const Model& model, const Model& other, const std::string& at, const SE3<double>& placement = {},
                     const std::string& prefix = "");

}  // namespace dyn
