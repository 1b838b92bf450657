// A robot as every library can hold it: one-axis joints about or along z, and a floating base. C++17, as some libraries' headers are.
#pragma once

#include <dyn/spatial/inertia.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn::benchmark::peers {

enum class Motion { revolute, prismatic, floating };

/// Link i is moved by joint i; parents come first, and 0 is the world.
struct Link {
  int parent = 0;
  Motion motion = Motion::revolute;
  SE3<double> placement;    ///< of the joint at zero, in the parent link's frame
  Inertia<double> inertia;  ///< in the link's frame, which is the joint's
  int joint = -1;           ///< number among the one-axis joints
};

struct Robot {
  std::string name;
  bool floating = false;  ///< link 1 flies
  int joints = 0;         ///< one-axis ones
  std::vector<Link> links;
  Vec3<double> gravity;
  std::shared_ptr<const void> compact, description;  ///< libdyn's CompactModel, from which all this was read, and its Model
};

/// Base: position and quaternion (x, y, z, w), velocity and acceleration in the base's own frame, linear first; zero without a base.
struct State {
  double base_q[7] = {0, 0, 0, 0, 0, 0, 1}, base_v[6] = {}, base_a[6] = {};
  std::vector<double> q, v, a;  ///< of the joints; a: forces for aba
};

/// Reads a URDF: fixed joints welded, mimic joints independent, no losses and limits. Throws Error, also for other joints.
Robot readRobot(const std::string& file, bool floating);
/// Random states; `still`: at rest, the base at the origin.
std::vector<State> randomStates(const Robot& robot, int count, bool still);

}  // namespace dyn::benchmark::peers
