// SPDX-License-Identifier: BSD-2-Clause
// The order in which the recursions of derivatives visit bodies or lane groups, and access to their results.
#pragma once

#include "kernels/derivative/derivatives.hpp"
#include "kernels/order/lane_group_scratch.hpp"
#include "kernels/order/lane_groups.hpp"

#include <algorithm>

namespace dyn::kernels {

/// The results of recursions over bodies, in scalars S, by body and by degree of freedom.
template <class S>
struct LeftByBodies {
  using Scalar = S;
  const Workspace<S>& w;
  const DerivativeWorkspace<S>& d;

  const Vec3<S>& offset(int i) const { return w.r[i]; }  ///< of body i's origin, from its parent's
  const Vec3<S>& offsetRate(int i) const { return d.shift_rate[i]; }
  const Vec3<S>& turning(int i) const { return w.w[i]; }  ///< angular velocity
  const Motion<S>& acceleration(int i) const { return w.acc[i]; }
  const Motion<S>& column(int dof) const { return w.dof[dof].column; }
  const DofVariation<S>& variation(int dof) const { return d.dof[dof]; }
};

/// The same for recursions over lane groups: each result is a lane of a pack.
struct LeftByLaneGroups {
  using Scalar = InOneLane;
  const LaneGroupPlan& plan;
  const LaneGroupArrays& arrays;

  Vec3<InOneLane> offset(int i) const { return {place<Vec3>(arrays.offsets, i)}; }
  Vec3<InOneLane> offsetRate(int i) const { return {place<Vec3>(arrays.offset_rates, i)}; }
  Vec3<InOneLane> turning(int i) const { return {place<Vec3>(arrays.turnings, i)}; }
  Motion<InOneLane> acceleration(int i) const { return motion(place<Motion>(arrays.accelerations, i)); }
  Motion<InOneLane> column(int dof) const { return motion(dofPlace<DofFactor>(arrays.dofs, dof)); }
  DofVariation<InOneLane> variation(int dof) const {
    constexpr int size = group_lanes * numbersIn<Motion>;
    const double* first = dofPlace<DofVariation>(arrays.variations, dof);
    return {motion(first), motion(first + size), motion(first + 2 * size)};
  }

 private:
  template <template <class> class T>
  static constexpr int numbersIn = sizeof(T<double>) / sizeof(double);
  template <template <class> class T>
  const double* place(const double* array, int body) const {
    const LaneSlot& lane_slot = plan.lane_slots[static_cast<std::size_t>(body)];
    return array + group_lanes * numbersIn<T> * lane_slot.group + lane_slot.lane;
  }
  template <template <class> class T>
  const double* dofPlace(const double* array, int dof) const {
    const auto number = static_cast<std::size_t>(plan.dof_place[static_cast<std::size_t>(dof)]);
    return array + group_lanes * numbersIn<T> * (number / group_lanes) + number % group_lanes;
  }
  static Motion<InOneLane> motion(const double* first) { return {{first}, {first + group_lanes * numbersIn<Vec3>}}; }
};

/// A recursion over bodies. A number of S and a number of T are the same in memory.
template <class Order, class S, class T>
struct BodyRecursion {
  using Scalar = S;
  static constexpr bool over_lane_groups = false;
  Order order;
  DerivativeWorkspace<S>& d;

  /// Numbers of the degrees of freedom, as the recursion reads them.
  const S* in(const T* numbers) const { return reinterpret_cast<const S*>(numbers); }
  const S* velocities(const T* v) const { return in(v); }
  const S* accelerations(const T* a) const { return in(a); }
  const Force<T>* external(const Force<T>* fext) const { return fext; }
  /// The same, as the recursion writes them.
  S* out(T* numbers) const { return reinterpret_cast<S*>(numbers); }
  /// Writes, by lane, the first body whose pivot vanished, or 0.
  void failures(int* to) const { std::copy(std::begin(order.w.failed), std::end(order.w.failed), to); }
};

/// The order that visits bodies one after the other.
template <class S>
struct OrderOf {
  using type = Bodies<S>;
  static type over(const CompactImpl& m, Workspace<S>& w) { return {m, w}; }
};

/// A recursion over the bodies of w, whose joints have been evaluated.
template <class S>
auto recursion(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  if constexpr (pack_width<S> == 1) {
    return BodyRecursion<typename OrderOf<S>::type, S, S>{OrderOf<S>::over(m, w), d};
  } else {
    d.bodies.joints = reinterpret_cast<JointMemory<Vectored>*>(w.joints);
    d.bodies.R[0] = d.bodies.product[0] = Mat3<Vectored>::identity();
    return BodyRecursion<VectoredBodies, Vectored, S>{{{{m, d.bodies}}}, *d.vectored};
  }
}

/// The memory of recursions over lane groups: their results, and their inputs in lanes.
template <class S>
struct LaneGroupDerivatives : LaneGroupScratch<S> {
  DerivativeWorkspace<S> d;
  Force<S>* fext;

  static std::size_t layOut(LaneGroupDerivatives& s, const CompactImpl& m, char* base) {
    Arena arena(base);
    LaneGroupScratch<S>::layOut(s, m, arena);
    s.d = {};
    layOutRecursions(s.d, m.lane_groups.lane_groups.size(), static_cast<std::size_t>(m.lane_groups.dofs), arena);
    arena.take(s.fext, m.lane_groups.lane_groups.size());
    return arena.used();
  }
  LaneGroupArrays arrays() const {
    const auto numbers = [](const auto* x) { return reinterpret_cast<const double*>(x); };
    const Workspace<S>& own = this->w;
    return {numbers(own.r), numbers(d.shift_rate), numbers(own.w), numbers(own.acc), numbers(own.dof), numbers(d.dof)};
  }
};

/// A recursion over lane groups. The model has no joints whose subspace varies with q.
template <class S>
struct LaneGroupRecursion {
  using Scalar = S;
  static constexpr bool over_lane_groups = true;
  LaneGroups<S, false> order;
  DerivativeWorkspace<S>& d;
  LaneGroupDerivatives<S>& s;

  const S* velocities(const double* v) const { return gatherDofs(order.m.lane_groups, v, s.v); }
  const S* accelerations(const double* a) const { return gatherDofs(order.m.lane_groups, a, s.a); }
  const Force<S>* external(const Force<double>* fext) const {
    if (fext == nullptr) return nullptr;
    static constexpr double none[sizeof(Force<double>) / sizeof(double)] = {};
    const LaneGroupPlan& plan = order.m.lane_groups;
    for (std::size_t i = 1; i < plan.lane_groups.size(); ++i) {
      const double* from[group_lanes];
      for (int l = 0; l < group_lanes; ++l) {
        const int body = plan.lane_groups[i].body[l];
        from[l] = body < 0 ? none : reinterpret_cast<const double*>(fext + body);
      }
      s.fext[i] = gatheredLanes<S, Force<S>, 1>(from);
    }
    return s.fext;
  }
  /// out() has room for numbers of the degrees of freedom in lanes; put() copies them to their places in the model's order.
  S* out(double*) const { return s.result; }
  void put(const S* numbers, double* to) const { scatterDofs(order.m.lane_groups, numbers, to); }
  void failures(int* to) const { *to = firstFailure(order.m, order.w); }
};

/// Copies the poses of joints, which have been evaluated one after the other, into lanes.
template <class S>
void slotPoses(const CompactImpl& m, const JointMemory<double>* from, const JointMemory<S>* to) {
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const LaneGroupBatch& lane_groups = m.lane_groups.batches[b];
    const int size = poseSize(m.batches[b].shape);
    if (m.batches[b].count == 1) {
      for (int c = 0; c < size; ++c) to[b].pose[c] = S(from[b].pose[c]);
      continue;
    }
    for (int c = 0; c < size; ++c)
      for (int k = 0; k < lane_groups.slots; ++k)
        to[b].pose[c * lane_groups.slots + k] = gathered<S>(from[b].pose + c * from[b].stride, lane_groups.pose_index.data() + group_lanes * k);
  }
}

/// Calls use(recursion): a recursion over lane groups, in the lanes of Quad, if `wanted` and if d has memory for it; otherwise one over bodies.
template <class Quad, class S, class Use>
decltype(auto) withRecursion(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, bool wanted, Use&& use) {
  if constexpr (std::is_same_v<S, double> && lanes_of<Quad> == group_lanes) {
    if (wanted && d.lane_groups) {
      auto& s = *reinterpret_cast<LaneGroupDerivatives<Quad>*>(d.lane_groups);
      slotPoses(m, w.joints, s.w.joints);
      return use(LaneGroupRecursion<Quad>{{m, s.w}, s.d, s});
    }
  }
  return use(recursion(m, w, d));
}

}  // namespace dyn::kernels
