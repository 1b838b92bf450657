// SPDX-License-Identifier: BSD-2-Clause
// The numbers of the compiler's working copy: poses and inertias of bodies, which the passes compose in long double, so that they are rounded once.
#pragma once

#include <dyn/joint/joint_type.hpp>
#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <mutex>
#include <vector>

namespace dyn {

using ExactInertias = std::vector<Inertia<long double>>;  ///< by body

/// The pose of a body. Parents come first; [0] is the world.
struct Link {
  int parent = 0;
  Shape shape = Shape::dense;
  int nv = 0;
  SE3<long double> placement;  ///< of the joint, in the parent's frame
  SE3<double> before, after;   ///< the constant parts of the joint's motion
};
struct LinkFrame {
  int body = 0;
  SE3<long double> placement;
};

/// Poses that do not depend on inertias.
struct Skeleton {
  std::vector<Link> links;  ///< of all bodies; those that move after weldLinks()
  std::vector<LinkFrame> frames;
  std::vector<int> kept;               ///< by moving body: its former number
  std::vector<int> carrier;            ///< by former number: the moving body that carries it; 0: the world
  std::vector<SE3<long double>> pose;  ///< by former number: its pose in that body's frame
  int turned = 0,                      ///< joint axes turned onto z
      along = 0;                       ///< of these, along axes of their parents
};
/// A frame as it was described: its body, and its pose there.
struct DescribedFrame {
  int body = 0;
  SE3<double> placement;
};
/// A skeleton that is made when it is first needed.
struct LazySkeleton {
  std::shared_ptr<const std::vector<DescribedFrame>> frames;
  std::once_flag once;
  Skeleton skeleton;
};

/// Joins rigid bodies to those that carry them: re-bases frames, and leaves the bodies that move.
void weldLinks(Skeleton& skeleton);
/// Moves the constant parts of each joint's motion into placements, so that every motion is that of its shape.
void turnLinks(Skeleton& skeleton);
/// Returns the inertias of the moving bodies with those of the bodies that are welded to them, after turnLinks().
ExactInertias carriedInertias(const Skeleton& skeleton, const ExactInertias& described);

/// Where the origin of a joint about z goes.
struct Origin {
  long double along = 0;  ///< its place on the axis, from its described place
  bool met = false;       ///< it is where the axis crosses its parent's
  bool operator==(const Origin&) const = default;
};
/// Finds origins where axes cross. Joint offsets become zero there.
std::vector<Origin> originsOnAxes(const Skeleton& skeleton, const ExactInertias& inertias);
/// Move inertias, and links and frames, to these origins.
/// @{
void moveInertias(ExactInertias& inertias, const std::vector<Origin>& origins);
void moveLinks(std::vector<Link>& links, std::vector<LinkFrame>& frames, const std::vector<Origin>& origins);
/// @}

/// Finds for each body whether it, or a body that it carries, has inertia.
std::vector<bool> carryInertia(const std::vector<Link>& links, const ExactInertias& inertias);

}  // namespace dyn
