// SPDX-License-Identifier: BSD-2-Clause
// The numbers of a description that a compact model keeps, so that withNumbers() can compose poses and inertias again. Bodies are in the order in
// which orderDepthFirst() leaves them: bodies that weld() later joins to others are among them, and so are the parts of joints made of joints.
#pragma once

#include "compile/links.hpp"
#include "compile/shared_vector.hpp"

#include <dyn/joint/shape.hpp>
#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// A body and its joint, without the numbers that can change.
struct DescribedBody {
  std::string name;                ///< of the described body; empty for the bodies between the parts of a joint
  std::string joint;               ///< of the described joint, for its first part; empty for other parts
  std::string part;                ///< the part's own name, for warnings
  int parent = 0;                  ///< index among these bodies
  Shape shape = Shape::dense;      ///< of the joint's core motion
  int nv = 0;                      ///< 0: rigid
  SE3<double> before, after;       ///< the constant parts of the joint's motion, as its type gives them
  std::vector<SE3<double>> inner;  ///< first parts: placements within the joint, outermost first
  bool held = false;               ///< rigid by reduce(), so that its placement contains a pose of its motion
  bool coupled = false;            ///< it depends on another joint
};

struct DescribedNumbers {
  SharedVector<DescribedBody> bodies;
  std::shared_ptr<LazySkeleton> skeleton;              ///< made of the placements; models with the same ones share it
  std::shared_ptr<const std::vector<Origin>> origins;  ///< by moving body
  SharedVector<Inertia<double>> inertias;              ///< by body
  SharedVector<SE3<double>> placements;                ///< by body; of the whole joint, for its first part
  SharedVector<double> damping, friction, armature;    ///< nvx numbers each, whether they act or not
  bool dissipation_acts = true, armature_acts = true;  ///< CompileOptions
  int first_massless = 0, massless = 0;  ///< warnings of joints that move no mass: the first one's place in the report, and their number
};

}  // namespace dyn
