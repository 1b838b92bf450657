// Mechanisms whose motion is known in closed form or to many digits: what methods are measured and tested on.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// A body on a revolute joint; returns its number.
int addBar(Model& model, const std::string& joint, int parent, const std::vector<double>& axis, const Vec3<double>& at, const Inertia<double>& Y);

/// Unit point masses at the ends of unit rods, angles relative, hanging along -z.
Model pendulum(int rods);
/// n links of 0.3 m and 1 to 2 kg on revolute joints whose axes turn from link to link, none of them parallel to the next.
Model chain(int links);
/// One body on a joint of this type, with its principal moments of inertia about its centre of mass.
Model body(const std::string& type, double mass, const Vec3<double>& com, const Vec3<double>& moments, double gravity);
/// Turns about its intermediate axis (Dzhanibekov): moments 1, 2, 3, no gravity.
Model freeBody();
/// Spins on its tip: mass and length 1, moments 2, 2, 0.5 about the tip.
Model heavyTop();
/// N unit squares of unit rods of 1 kg side by side, upright at zero: the first crank, then a coupler and a crank for each, loops closed
/// (IFToMM A02). All pass at once through the position where their bars are in line.
Model fourBars(int squares);
/// The one crank that moves as all of theirs do, with the couplers' mass at its end.
Model fourBarsCrank(int squares);

}  // namespace dyn::tool
