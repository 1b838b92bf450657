// SPDX-License-Identifier: BSD-2-Clause
#include "joints.hpp"
#include "types.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::mjcf {

namespace {

using Numbers = std::vector<double>;

/// Turns a planar vector by the angle of q's last two numbers.
void turn(double c, double s, double& x, double& y) {
  const double n = std::hypot(c, s), a = (c * x - s * y) / n, b = (s * x + c * y) / n;
  x = a;
  y = b;
}

/// A state of a joint as its numbers come, which parts take one after the other.
struct StateReader {
  const double *q, *v;
  Numbers &qpos, &qvel;

  void take(const JointDescription& joint, bool on_world) {
    if (joint.type == "composite") {
      for (const JointDescription& part : partsOf(joint)) take(part, false);
      return;
    }
    const Space& space = spaceOf(joint);
    Numbers x(q, q + space.neutral.size()), w(v, v + space.nv);
    q += x.size();
    v += w.size();
    if (joint.type == "continuous") {
      x = {std::atan2(x[1], x[0])};
    } else if (joint.type == "planar") {
      turn(x[2], x[3], w[0], w[1]);
      x = {x[0], x[1], std::atan2(x[3], x[2])};
    } else if (joint.type == "helical") {
      x.push_back(pitchOf(joint) * x[0]);
      w.push_back(pitchOf(joint) * w[0]);
    } else if (joint.type == "spherical") {
      std::rotate(x.begin(), x.end() - 1, x.end());
    } else if (joint.type == "free_flyer") {
      const Quaternion<double> r = Quaternion<double>{x[3], x[4], x[5], x[6]}.normalized();
      SE3<double> X{r.matrix(), {x[0], x[1], x[2]}};
      if (on_world) X = joint.placement * X;
      // A free joint's linear velocity is in the world's axes, and in those of the slides.
      const Vec3<double> linear = X.R * Vec3<double>{w[0], w[1], w[2]};
      const Quaternion<double> turned = on_world && !isIdentity(cast<long double>(joint.placement.R)) ? quaternionOf(X.R) : r;
      x = {X.p.x, X.p.y, X.p.z, turned.w, turned.x, turned.y, turned.z};
      for (int k = 0; k < 3; ++k) w[static_cast<std::size_t>(k)] = linear[k];
    }
    qpos.insert(qpos.end(), x.begin(), x.end());
    qvel.insert(qvel.end(), w.begin(), w.end());
  }
};

void addNeutral(const JointDescription& joint, Numbers& q, std::size_t& nv) {
  if (joint.type == "composite") {
    for (const JointDescription& part : partsOf(joint)) addNeutral(part, q, nv);
    return;
  }
  const Space& space = spaceOf(joint);
  q.insert(q.end(), space.neutral.begin(), space.neutral.end());
  nv += space.nv;
}

}  // namespace

void appendState(const JointDescription& joint, bool on_world, const JointState& state, Numbers& qpos, Numbers& qvel) {
  Numbers q;
  std::size_t nv = 0;
  addNeutral(joint, q, nv);
  for (const auto& [given, size, what] : {std::tuple{&state.q, q.size(), "coordinates"}, {&state.v, nv, "velocities"}})
    if (!given->empty() && given->size() != size)
      refuse(joint, "a named state has " + std::to_string(given->size()) + " " + what + " of it, but it has " + std::to_string(size));
  if (!state.q.empty()) q = state.q;
  const Numbers v = state.v.empty() ? Numbers(nv, 0) : state.v;
  StateReader{q.data(), v.data(), qpos, qvel}.take(joint, on_world);
}

}  // namespace dyn::mjcf
