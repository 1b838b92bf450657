// SPDX-License-Identifier: BSD-2-Clause
// Sums over the bodies after forwardKinematics(): the centre of mass with its motion, and energies.
#pragma once

#include "kernels/order/body_order.hpp"
#include "kernels/recursion/kinematics.hpp"

#include <cmath>

namespace dyn::kernels {

/// A sum that also adds up its rounding errors (Neumaier 1974), because the energies of bodies above and below the origin may cancel.
template <class S>
class CompensatedSum {
 public:
  void add(const S& x) {
    using std::abs;
    const S next = sum_ + x;
    lost_ += select(abs(sum_) >= abs(x), (sum_ - next) + x, (x - next) + sum_);
    sum_ = next;
  }
  S total() const { return sum_ + lost_; }

 private:
  S sum_{0}, lost_{0};
};

/// Position, velocity and acceleration of the centre of mass, in world axes.
template <class S>
struct MassMotion {
  Vec3<S> position{}, velocity{}, acceleration{};
};

/// Calls use(i, mass, centre, inertia about the centre) for each body, in body axes.
template <class S, class Order, class Use>
void eachBody(const Order& order, Use&& use) {
  for (int i = 1; i < order.m.bodies(); ++i) withInertia(order, i, [&](const auto& c) { use(i, S(c.mass), cast<S>(c.com), cast<S>(c.rotational)); });
}

/// The origin of body i's joint in the parent's axes. For many states at once, w.rel has only those that a joint moves.
template <class S, class Order>
Vec3<S> jointOrigin(const Order& order, const Workspace<S>& w, int i) {
  if constexpr (Order::lanes_are_states) {
    const auto batch = static_cast<std::size_t>(order.m.index[static_cast<std::size_t>(i)].batch);
    if (order.m.batches[batch].shape == Shape::revolute) return cast<S>(order.constants(i).placement.p);
  }
  return w.rel[i].p;
}

/// Velocity and acceleration are zero unless they are asked for. w must have placements, and the
/// velocities and accelerations that are asked for. w.origin gets the classical acceleration of each joint's place on the parent, in world axes.
template <class S, class Order>
MassMotion<S> centerOfMass(const Order& order, Workspace<S>& w, bool velocity, bool acceleration) {
  S total(0);
  MassMotion<S> sum;
  eachBody<S>(order, [&](int i, const S& mass, const Vec3<S>& com, const auto&) {
    const Mat3<S>& R = w.oM[i].R;
    total += mass;
    sum.position += mass * w.oM[i].act(com);
    if (!velocity) return;
    sum.velocity += mass * (R * (w.v[i].linear + cross(w.v[i].angular, com)));
    if (!acceleration) return;
    const BodyIndex& x = order.m.index[static_cast<std::size_t>(i)];
    Vec3<S>& origin = w.origin[i];
    origin = {};
    if (x.parent != 0) {
      const int p = x.parent;
      origin = w.origin[p] + w.oM[p].R * (w.sliding[p] + beyondOrigin(w.a[p].angular, w.v[p].angular, jointOrigin(order, w, i)));
    }
    sum.acceleration += mass * (origin + R * (w.sliding[i] + beyondOrigin(w.a[i].angular, w.v[i].angular, com)));
  });
  const S share = S(1) / total;
  return {share * sum.position, share * sum.velocity, share * sum.acceleration};
}

/// With the energy of rotors. v is in expanded coordinates.
template <class S, class Order>
S kineticEnergy(const Order& order, const Workspace<S>& w, const S* v) {
  S twice(0);
  eachBody<S>(order, [&](int i, const S& mass, const Vec3<S>& com, const Sym3<S>& rotational) {
    const Vec3<S> linear = w.v[i].linear + cross(w.v[i].angular, com);
    twice += mass * dot(linear, linear) + dot(w.v[i].angular, rotational * w.v[i].angular);
  });
  for (std::size_t k = 0; k < order.m.armature.size(); ++k) twice += S(static_cast<Real<S>>(order.m.armature[k])) * v[k] * v[k];
  return S(0.5) * twice;
}

template <class S, class Order>
S potentialEnergy(const Order& order, const Workspace<S>& w) {
  CompensatedSum<S> energy;
  const Vec3<S> gravity = cast<S>(order.m.gravity);
  eachBody<S>(order, [&](int i, const S& mass, const Vec3<S>& com, const auto&) { energy.add(-mass * dot(gravity, w.oM[i].act(com))); });
  return energy.total();
}

}  // namespace dyn::kernels
