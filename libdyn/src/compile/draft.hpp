// SPDX-License-Identifier: BSD-2-Clause
// The compiler's working copy: bodies by index, joints resolved to types. Passes read and write this and nothing else.
// Poses and inertias are composed in long double, so that the numbers that pack() stores are rounded only once.
#pragma once

#include "joint/coordinate.hpp"

#include <dyn/compile/compile.hpp>

#include <optional>
#include <string>
#include <vector>

namespace dyn {

/// Parameters that were checked against a schema. The struct owns the memory to which the plugin's view points.
struct CheckedParameters {
  std::vector<std::vector<double>> numbers;
  std::vector<std::string> texts;
  std::vector<bool> given;
  std::vector<ParameterArgument> arguments() const;
};

struct DraftCoupling {
  const CouplingType* type = nullptr;
  std::vector<double> constants;
  int master = -1;  ///< draft body
  int rank = 1;     ///< number of masters above, one after the other
};

struct DraftBody {
  std::string name;  ///< of the body
  JointDescription joint;
  int user_joint = -1;               ///< index of the described body whose joint this is, or is a part of
  std::string user_name, user_type;  ///< of that joint
  bool last_part = true;             ///< true for the described body, false for the massless bodies between the parts of a composite
  int parent = 0;
  Inertia<long double> inertia;
  const JointType* type = nullptr;
  const JointType* fast = nullptr;  ///< built for this processor
  JointInstance instance;
  std::vector<double> constants;
  SE3<long double> placement;  ///< pose of the joint in the parent's frame
  std::optional<DraftCoupling> coupling;

  JointPlace place() const { return {type, constants.data(), instance.constant_count}; }
};

struct DraftFrame {
  std::string name;
  int body = 0;
  SE3<long double> placement;
};

struct Draft {
  std::string name;
  Vec3<double> gravity;
  std::vector<DraftBody> bodies;  ///< [0] is the world; parents first
  std::vector<DraftFrame> frames;
  CompileReport report;
};

/// 1. Puts every described body into the draft, looks up joints, checks parameters, and expands series of joints into bodies without mass.
///    Guarantees: each body has a type and an instance; couplings name their master; names of bodies, joints and frames are unique.
Draft resolve(const Model& model, const JointRegistry& registry);
/// 2. Orders bodies depth first, children in the order of the description. Frames follow their bodies.
void orderDepthFirst(Draft& draft);
/// 3. Welds joints without freedom: adds inertias and re-bases frames. Guarantees nv > 0 for every body but the world.
void weld(Draft& draft);
/// 4. Moves the constant parts of each joint's motion into placements, inertias and frames. Guarantees that every core motion is that of its shape.
void canonicalise(Draft& draft);
/// 5. Warns of joints that move no inertia, because they make the mass matrix singular everywhere.
void inspect(Draft& draft);
/// 6. Turns the position and velocity limits of dependent joints into limits of their masters. A dependent coordinate is a function of its master's.
///    If its limits allow several ranges of the master's coordinate, the one nearest to 0 is meant.
void passLimitsOn(Draft& draft);
/// 7. Makes the arrays over which the recursions run.
std::shared_ptr<CompactImpl> pack(Draft&& draft, const CompileOptions& options);

}  // namespace dyn
