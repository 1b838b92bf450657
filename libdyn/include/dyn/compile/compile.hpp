// SPDX-License-Identifier: BSD-2-Clause
// compile(): turns a description into a compact model.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/compile/edit.hpp>
#include <dyn/compile/scene.hpp>

#include <string>

namespace dyn {

/// Choices of compile().
struct CompileOptions {
  std::vector<LockedJoint> lock{};  ///< joints to hold, as reduce() does
  bool dissipation = true;          ///< joint damping and friction of the description act in the dynamics
  bool armature = true;             ///< so does its rotor inertia
  /// Single states advance up to four joints of one type together, as those of two legs and two arms, where that is faster: a lane group.
  /// CompileReport::passes says where. If false, never.
  bool lane_groups = true;
  /// The instruction set that lane groups are chosen for, by its name in DYN_SIMD ("scalar", "avx2", ...). Empty: the set in use in this process.
  std::string instruction_set{};
  Scene scene{};  ///< the wanted parts; the rest is left out, and the report says so
};

/// Turns a description into an immutable model. Deterministic: the same model, options and instruction set give the same bytes. O(n log n). Throws
/// Error(model | joint_type | parameter | size | plugin), which names the joint, and Error(argument) for an unknown instruction set or a joint to
/// hold without a name.
DYN_API CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options = {});

}  // namespace dyn
