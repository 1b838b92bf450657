// SPDX-License-Identifier: BSD-2-Clause
// The compiler's working copy: bodies by index, joints resolved to types. Passes read and write this and nothing else.
#pragma once

#include "compile/compact_impl.hpp"
#include "compile/links.hpp"
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
  bool first_part = false;           ///< it is the first part of that joint, or the whole joint
  bool last_part = true;             ///< true for the described body, false for the massless bodies between the parts of a composite
  SE3<double> user_placement;        ///< first parts: of that joint
  std::vector<SE3<double>> inner;    ///< first parts: placements within that joint, outermost first
  bool held = false;                 ///< first parts: JointDescription::held of that joint
  const JointType* type = nullptr;
  const JointType* fast = nullptr;  ///< built for this processor
  JointInstance instance;
  std::vector<double> constants;
  std::optional<DraftCoupling> coupling;

  JointPlace place() const { return {type, constants.data(), instance.constant_count}; }
};

struct Draft {
  std::string name;
  Vec3<double> gravity;
  std::vector<DraftBody> bodies;  ///< [0] is the world; parents first
  Skeleton skeleton;              ///< their poses, and the frames
  ExactInertias inertias;         ///< their inertias; since canonicalise with those of the bodies that are welded to them
  std::vector<std::string> frame_names;
  DescribedNumbers described;  ///< set between order and weld
  CompileReport report;
};

/// Adds a pass's line to the report, or replaces it.
void notePass(CompileReport& report, const std::string& pass, const std::string& text);
void noteCanonical(CompileReport& report, const Skeleton& skeleton, const std::vector<Origin>& origins);
std::string masslessWarning(const std::string& joint);

/// 1. Puts every described body into the draft, looks up joints, checks parameters, and expands series of joints into bodies without mass.
///    Guarantees: each body has a type and an instance; couplings name their master; names of bodies, joints and frames are unique.
Draft resolve(const Model& model, const JointRegistry& registry);
/// 2. Orders bodies depth first, children in the order of the description. Frames follow their bodies.
void orderDepthFirst(Draft& draft);
/// Keeps the described numbers of a draft in this order, so that withNumbers() can make the numbers of the compact model again.
void keepDescribed(Draft& draft);
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

// The numbers of a compact model: what pack() and withNumbers() write in the same way. Members that already have the right value stay shared.

/// Writes placements of bodies and frames, and all that follows from them. `links` and `frames` are canonical.
void writePlacements(CompactImpl& out, const std::vector<Link>& links, const std::vector<LinkFrame>& frames);
/// Writes the constants that follow from the inertias of the moving bodies.
void writeInertias(CompactImpl& out, const ExactInertias& inertias);
/// A body's numbers, rounded once.
InertiaConstants<double> inertiaConstants(const Inertia<long double>& inertia);
/// Writes the dissipation and armature that act, and their line of the report, from `described`.
void writeDissipation(CompactImpl& out);

}  // namespace dyn
