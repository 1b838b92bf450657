// compile(): from a description to a compact model.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/compile/edit.hpp>
#include <dyn/compile/scene.hpp>

namespace dyn {

struct CompileOptions {
  std::vector<LockedJoint> lock{};  ///< joints to hold, as reduce() does
  bool dissipation = true;          ///< joint damping and friction of the description act in the dynamics
  bool armature = true;             ///< so does rotor inertia
  bool strips = true;               ///< single states advance joints of several limbs side by side where that is faster; false: one after the other
  Scene scene{};                    ///< what is wanted: the rest is left out, and the report says so
};

/// Turns a description into an immutable model. Deterministic: same model, same options, same bytes. O(n log n).
/// Throws Error(model | joint_type | parameter | size | plugin), naming the joint.
DYN_API CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options = {});

}  // namespace dyn
