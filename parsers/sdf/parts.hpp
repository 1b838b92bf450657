// SPDX-License-Identifier: BSD-2-Clause
// libsdformat's objects as parts of a Model.
#pragma once

#include "common/reader.hpp"
#include "messages.hpp"

#include <dyn/model/model.hpp>

#include <optional>
#include <sdf/Collision.hh>
#include <sdf/Joint.hh>
#include <sdf/Link.hh>
#include <sdf/Model.hh>
#include <sdf/Visual.hh>
#include <sdf/World.hh>
#include <string>
#include <vector>

namespace dyn::sdf {

/// Everything that functions of this folder need of the file.
struct Context {
  const Sources& sources;
  const LoadOptions& options;
  reader::Notes& notes;

  /// Returns the place of an element.
  template <class Part>
  Where where(const Part& part, const std::string& joint = {}) const {
    const ::sdf::ElementPtr e = part.Element();
    if (!e) return {sources.original(""), 0, joint};
    return {sources.original(e->FilePath()), e->LineNumber().value_or(0), joint};
  }
};

SE3<double> poseOf(const ignition::math::Pose3d& pose);
Vec3<double> vectorOf(const ignition::math::Vector3d& v);

/// Returns the pose of a part relative to a frame of its scope, by default to the frame around it.
template <class Part>
SE3<double> resolved(const Context& context, const Part& part, const std::string& relative_to = {}) {
  ignition::math::Pose3d pose;
  throwFirst(part.SemanticPose().Resolve(pose, relative_to), context.sources);
  return poseOf(pose);
}

/// The inertia of a link in its own frame.
Inertia<double> inertiaOf(const Context& context, const ::sdf::Link& link, const std::string& name);

/// The volumes of a link, on body `body`, seen from a frame in which the link has the pose `placement`.
std::vector<GeometryDescription> geometriesOf(const Context& context, const ::sdf::Link& link, const std::string& name, int body);

/// A joint, before the tree is known. Its two links are numbers in the list of links; -1 is the world.
struct JointRead {
  const ::sdf::Joint* joint = nullptr;
  std::string name;
  int parent = -1, child = -1;
  SE3<double> in_parent, in_child;  ///< the joint's frame in both links at the zero configuration
  double size = 0;                  ///< length with which the rounding of these poses grows [m]
  bool cut = false;                 ///< the file says that a loop is cut here
};

/// The joint's motion, seen from its child link if the link's origin is the joint's, or from the joint's own frame.
struct JointMotion {
  JointDescription joint;
  bool from_link = false;
};
/// Returns a joint of the tree. If `reversed`, it carries its parent from its child. Throws Error(model) for what no joint type of libdyn does.
JointMotion motionOf(const Context& context, const JointRead& read, bool reversed);

/// Returns the constraint that stands for a joint which closes a loop, between bodies of these names.
ConstraintDescription closureOf(const Context& context, const JointRead& read, const std::string& parent, const std::string& child);

/// Returns the constraint of a gearbox, between the joints of the tree that carry its two links from the reference body.
ConstraintDescription gearOf(const Context& context, const JointRead& gearbox, const JointRead& first, const JointRead& second);

}  // namespace dyn::sdf
