// The compiler's working copy: bodies by index, joints resolved to types. Passes read and write this and nothing else.
// Poses and inertias are composed in long double, so that what pack() stores has been rounded once.
#pragma once

#include "joint/coordinate.hpp"

#include <dyn/compile/compile.hpp>

#include <optional>
#include <string>
#include <vector>

namespace dyn {

/// Parameters checked against a schema, owning what the plugin's view points at.
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
  int rank = 1;     ///< how many masters are above, one after the other
};

struct DraftBody {
  std::string name;  ///< of the body
  JointDescription joint;
  int user_joint = -1;               ///< index of the described body whose joint this is (a part of)
  std::string user_name, user_type;  ///< of that joint
  bool last_part = true;             ///< the body itself; false for the massless bodies between the parts of a composite
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
  std::vector<DraftBody> bodies;  ///< [0] is the universe; parents first
  std::vector<DraftFrame> frames;
  CompileReport report;
};

/// 1. Every described body in the draft, joints looked up, parameters checked, series of joints expanded into bodies without mass.
///    Guarantees: each body has a type and an instance; couplings name their master; names of bodies, joints and frames are unique.
Draft resolve(const Model& model, const JointRegistry& registry);
/// 2. Depth first, children in the order of the description; frames follow their bodies.
void orderDepthFirst(Draft& draft);
/// 3. Joints without freedom are welded: inertias summed, frames re-based. Guarantees nv > 0 for every body but the universe.
void weld(Draft& draft);
/// 4. The constant parts of each joint's motion move into placements, inertias and frames: every core motion is of its shape.
void canonicalise(Draft& draft);
/// 5. Warnings for what would make the mass matrix singular everywhere: moving leaves without inertia.
void inspect(Draft& draft);
/// 6. Limits of position and velocity of joints that follow others become limits of those that lead: what they follow there is a function of
///    one coordinate, and where it has several ranges that are allowed the one nearest to 0 is meant.
void passLimitsOn(Draft& draft);
/// 7. The arrays that the recursions run over.
std::shared_ptr<CompactImpl> pack(Draft&& draft, const CompileOptions& options);

}  // namespace dyn
