// SPDX-License-Identifier: BSD-2-Clause
// Mechanisms whose motion is known in closed form or to many digits. Methods are measured and tested on them.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// Adds a body on a revolute joint with inertia Y; `at` is the joint's origin in the parent. Returns the body's number.
int addBar(Model& model, const std::string& joint, int parent, const std::vector<double>& axis, const Vec3<double>& at, const Inertia<double>& Y);

/// Unit point masses at the ends of unit rods, with relative angles; all rods hang along -z at zero.
Model pendulum(int rods);
/// n links of 0.3 m and 1 to 2 kg on revolute joints. The axes turn from link to link; no two consecutive ones are parallel.
Model chain(int links);
/// One body on a joint of this type, with its principal moments of inertia about its centre of mass.
Model body(const std::string& type, double mass, const Vec3<double>& com, const Vec3<double>& moments, double gravity);
/// A free body for rotation about its intermediate axis (Dzhanibekov effect): moments 1, 2, 3, no gravity.
Model freeBody();
/// A top on its tip: mass and length 1, moments 2, 2, 0.5 about the tip.
Model heavyTop();
/// N unit squares of unit rods of 1 kg side by side, upright at zero: the first crank, then a coupler and a crank for each square, with closed loops
/// (IFToMM A02). All squares pass at once through the position where their bars are in line.
Model fourBars(int squares);
/// A single crank that moves as all cranks of fourBars do: it has their inertia, and the couplers' mass at its end.
Model fourBarsCrank(int squares);

}  // namespace dyn::tool
