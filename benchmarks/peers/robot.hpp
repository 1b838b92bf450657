// SPDX-License-Identifier: BSD-2-Clause
// A robot that every library can represent: one-axis joints about or along z, and a floating base. This header is C++17, because some libraries'
// headers need it.
#pragma once

#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn::benchmark::peers {

enum class Motion { revolute, prismatic, floating };

/// Joint i moves link i. Parents come first; link 0 is the world.
struct Link {
  int parent = 0;
  Motion motion = Motion::revolute;
  SE3<double> placement;    ///< pose of the joint at zero in the parent link's frame
  Inertia<double> inertia;  ///< in the link's frame, which is the joint's frame
  int joint = -1;           ///< index among the one-axis joints; -1 for the world and the floating base
};

struct Robot {
  std::string name;
  bool floating = false;  ///< link 1 is a floating base
  int joints = 0;         ///< number of one-axis joints
  std::vector<Link> links;
  Vec3<double> gravity;
  std::shared_ptr<const void> compact, description;  ///< libdyn's CompactModel, from which this robot was read, and its Model
};

/// base_q: position and quaternion (x, y, z, w). base_v, base_a: in the base's own frame, linear part first. All unused without a floating base.
struct State {
  double base_q[7] = {0, 0, 0, 0, 0, 0, 1}, base_v[6] = {}, base_a[6] = {};
  std::vector<double> q, v, a;  ///< of the joints; for aba, a holds the forces
};

/// Reads a URDF: merges fixed joints, makes mimic joints independent, ignores dissipation and limits. Throws Error, also for joints that are not
/// one-axis.
Robot readRobot(const std::string& file, bool floating);
/// Returns random states; with `still` they are at rest with the base at the origin.
std::vector<State> randomStates(const Robot& robot, int count, bool still);

}  // namespace dyn::benchmark::peers
