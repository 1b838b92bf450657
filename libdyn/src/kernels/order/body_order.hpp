// SPDX-License-Identifier: BSD-2-Clause
// The interface between a recursion and the order in which it visits bodies.
//
// The recursions in recursion/ and derivative/ are written once, as what happens at one body. An order visits the bodies, hands each of them its
// joint, and moves numbers between neighbours. There are six:
//   Bodies          one body after the other; S is a number, or a pack whose lanes are states (order/sweep.hpp)
//   CachedBodies    the same, with numbers for the next body in registers (order/register_cached.hpp)
//   VectoredBodies  the same with the three coordinates of a vector in one register (order/vectored_bodies.hpp)
//   TurningBodies   the same for constants that multiply vectors from the left (isa/vectored_kernels.hpp)
//   LaneGroups      four joints at a time, one in each lane (order/lane_groups.hpp)
//   TracedBodies    symbolic numbers, which record the operations (codegen/traced_bodies.hpp)
#pragma once

#include <concepts>
#include <tuple>

namespace dyn::kernels {

/// Stands for the function that forward() and backward() call at each body.
struct AnyVisit {
  template <class Joint, class... Passed>
  void operator()(const Joint&, int, int, Passed&&...) const {}
};

/// S is the scalar of the order's workspace. `i` numbers bodies (of LaneGroups: lane groups), `k` degrees of freedom.
///
///     order.forward(passing(w.v, w.a), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& velocity, auto&& acceleration) { ... });
///
/// calls the function for each body, parents first; iv is the first degree of freedom of body i. For each array there is one more argument:
/// get() reads the number of the parent, leave(x) writes that of body i. backward() visits children first; there with(own) is the sum of `own` and
/// of all that the children gave, and give(x) adds x to the parent's sum.
///
/// `shared_constants`: constants(i) is the same in all lanes, so code may branch on it. `lanes_are_states`: the lanes of S are states of one body.
/// A body then has more numbers than there are registers, and reading them again from memory is faster than keeping them. `latency_bound`: the pose
/// of one body is all that the next one waits for, so corrections of rotations are computed beside the chain of products (Workspace::product).
template <class O>
concept BodyOrder = requires(const O& order, double* array, double number, int i, int k) {
  requires std::same_as<decltype(O::latency_bound), const bool>;
  requires std::same_as<decltype(O::shared_constants), const bool>;
  requires std::same_as<decltype(O::lanes_are_states), const bool>;
  order.m;                                       // the compiled model
  order.w;                                       // Workspace<S>
  order.constants(i).placement;                  // BodyConstants: placement, mass, com, rotational, h, origin
  order.armature(k);                             // S
  order.gravity();                               // Vec3<S>
  { order.isRoot(i) } -> std::same_as<bool>;     // the world carries it
  { order.isLeaf(i) } -> std::same_as<bool>;     // it carries nothing
  { order.hasOffset(i) } -> std::same_as<bool>;  // false: its origin coincides with the parent's
  { order.nv(i) } -> std::same_as<int>;
  order.parent(array, i);            // the parent's entry
  order.handOver(array, i, number);  // adds to the parent's entry; the first child to come begins the sum
  order.unite(i, number);            // sums up lanes that are copies of one body
  order.forward(std::tuple<>(), AnyVisit());
  order.backward(std::tuple<>(), AnyVisit());
};

/// Calls use(c) with the constants of body i, whose placement is not read. Results are those of the state in each lane, where these are of different
/// models.
template <BodyOrder Order, class Use>
decltype(auto) withInertia(const Order& order, int i, Use&& use) {
  if constexpr (requires { order.ownInertia(i); })
    if (const auto* own = order.ownInertia(i)) [[unlikely]]
      return use(*own);
  return use(order.constants(i));
}

}  // namespace dyn::kernels
