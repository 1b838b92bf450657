// New models from old ones: joints held, models joined. Descriptions in, descriptions out; nothing is lost on the way.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn/model/model.hpp>

namespace dyn {

/// A joint held at a configuration (its nq numbers; empty: neutral).
struct LockedJoint {
  std::string joint;
  std::vector<double> q;
};

/// The model with these joints rigid: they become joints of type "fixed" at the pose they are held at, keep their names, bodies, frames
/// and inertias, and lose limits, losses and armature, which rigid joints do not have. Joints that follow a held one are held where
/// it puts them, unless they are named themselves, and so are parts that do. A held joint that follows another one, or a part of it that does, is
/// held where neutral() has it; of a joint with such parts q has the numbers of the others alone. Throws Error(model) for a joint that does not exist
/// or is named twice, Error(size) for a q of the wrong size.
DYN_API Model reduce(const Model& model, const JointRegistry& registry, const std::vector<LockedJoint>& lock);

/// The model with all joints rigid at neutral but those named in `keep` (and the joints they follow).
DYN_API Model keepOnly(const Model& model, const JointRegistry& registry, const std::vector<std::string>& keep);

/// `model` with a copy of `other` carried by the body or frame called `at`, at `placement` in it. Names of the copy get `prefix`.
/// Gravity and name are the first model's. Throws Error(model) if `at` does not exist or a name would be used twice.
DYN_API Model append(const Model& model, const Model& other, const std::string& at, const SE3<double>& placement = {},
                     const std::string& prefix = "");

}  // namespace dyn
