// SPDX-License-Identifier: BSD-2-Clause
// Visits the lane groups of a model, four joints in the lanes of a pack, as Bodies visits bodies.
#pragma once

#include "kernels/body/shapes.hpp"
#include "kernels/order/lane_group_entry.hpp"
#include "kernels/order/register_cached.hpp"

namespace dyn::kernels {

/// `varying`: joints whose subspace varies with q are allowed as well.
template <class S, bool varying = true>
struct LaneGroups {
  static constexpr bool latency_bound = false, shared_constants = false, lanes_are_states = false;

  const CompactImpl& m;
  Workspace<S>& w;

  const BodyConstants<S>& constants(int i) const { return reinterpret_cast<const BodyConstants<S>*>(m.lane_groups.constants.data())[i]; }
  S armature(int dof) const { return S::load(m.lane_groups.armature.data() + group_lanes * dof); }
  Vec3<S> gravity() const { return cast<S>(m.gravity); }
  bool isRoot(int i) const { return group(i).depth == 1; }
  bool hasOffset(int) const { return true; }

  /// The parents' entries, each in the lane of its child.
  template <class T>
  T parent(const T* array, int i) const {
    const LaneGroup& s = group(i);
    if (s.same_lanes) return array[s.parents[0].group];
    if (s.apart) {
      const double* first[group_lanes];
      for (int l = 0; l < group_lanes; ++l) first[l] = reinterpret_cast<const double*>(array + s.lane_parents[l].group) + s.lane_parents[l].lane;
      return gatheredLanes<S, T>(first);
    }
    T out = of(s.parents[0], array);
    for (int p = 1; p < s.parents_count; ++p) {
      const auto here = lanes<S>(s.parents[p].lanes);
      const T more = of(s.parents[p], array);
      for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = select(here, packsOf<S>(more)[k], packsOf<S>(out)[k]);
    }
    return out;
  }
  /// Adds to the parents' entries. The first child to come begins the sum. Entries of leaves stay unchanged.
  template <class T>
  void handOver(T* array, int i, const T& value) const {
    const LaneGroup& s = group(i);
    if (s.gives_all && s.parents[0].first) {
      array[s.parents[0].group] = value;
      return;
    }
    for (int p = 0; p < s.parents_count; ++p)
      if (s.parents[p].first) array[s.parents[p].group] = T{};
    addToParent(array, i, value);
  }
  bool isLeaf(int i) const { return group(i).leaf; }
  int nv(int i) const { return group(i).nv; }
  template <class T>
  static constexpr bool caches = fits_registers<S, T>;
  /// Whether lane group i - 1 has all parents of lane group i, lane by lane.
  bool goesOn(int i, int first) const { return i > first && group(i).same_lanes && group(i).parents[0].group == i - 1; }
  /// Whether lane group i hands everything to lane group i - 1, lane by lane.
  bool goesBack(int i, int first) const { return i > first && group(i).gives_all && group(i).parents[0].group == i - 1; }
  /// Whether other lane groups than i + 1 hand something to lane group i. Lane group i + 1 hands it everything.
  bool branches(int i) const { return !group(i + 1).parents[0].first; }
  /// If one body is in several lanes, each of these lanes gets their sum.
  template <class T>
  void unite(int i, T& value) const {
    const LaneGroup& s = group(i);
    for (const unsigned united : s.united) {
      if (united == 0) return;
      const auto here = lanes<S>(united);
      for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
        S& x = packsOf<S>(value)[k];
        x = select(here, sumInAll(select(here, x, S(0))), x);
      }
    }
  }

  using Entries = double;
  using Entry = LaneGroupEntry<S>;
  Entry entry(double* M, int i, int) const { return {m, M, i}; }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const LaneGroupRun& run : m.lane_groups.runs)
      withShape<S, false, varying>(run.shape, run.nv, [&]<class Joint>() {
        const auto step = [&](int i, auto&... from) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, group(i).dof, from...);
        };
        forwardCached(*this, run.first, run.end, arrays, step);
      });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = m.lane_groups.runs.rbegin(); run != m.lane_groups.runs.rend(); ++run)
      withShape<S, false, varying>(run->shape, run->nv, [&]<class Joint>() {
        const auto step = [&](int i, auto&... from) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, group(i).dof, from...);
        };
        backwardCached(*this, run->first, run->end, arrays, step);
      });
  }

 private:
  template <class T>
  void addToParent(T* array, int i, const T& value) const {
    const LaneGroup& s = group(i);
    if (s.gives_all) {
      array[s.parents[0].group] += value;
    } else if (packs_in<S, T> <= 6 && s.apart) {
      // This is for forces and other small structs. Measured: written number by number, articulated inertias slow down all lane groups in aba.
      const T given = value;
      for (int l = 0; l < group_lanes; ++l) {
        const LaneParent& parent = s.lane_parents[l];
        if (!parent.given) continue;
        double* to = reinterpret_cast<double*>(array + parent.group) + parent.lane;
        const double* from = reinterpret_cast<const double*>(&given) + l;
        for (std::size_t k = 0; k < packs_in<S, T>; ++k) to[group_lanes * k] += from[group_lanes * k];
      }
    } else {
      for (int p = 0; p < s.parents_count; ++p) give(s.parents[p], array, value);
    }
  }
  const LaneGroup& group(int i) const { return m.lane_groups.lane_groups[static_cast<std::size_t>(i)]; }
  Slot<S> slotOf(int i) const {
    const LaneGroup& s = group(i);
    const JointMemory<S>& b = w.joints[s.batch];
    return {b.pose + s.slot, b.subspace ? b.subspace + s.slot : nullptr, b.stride, nullptr, b.bias ? b.bias + s.slot : nullptr, b.stride, s.nv};
  }
  template <class T>
  static T of(const LaneGroupParents& parents, const T* array) {
    const T& all = array[parents.group];
    return parents.lane < 0 ? all : inAllLanes<S>(all, parents.lane);
  }
  template <class T>
  static void give(const LaneGroupParents& parents, T* array, const T& value) {
    S* to = packsOf<S>(array[parents.group]);
    const auto given = lanes<S>(parents.given);
    const auto there = lanes<S>(1U << std::max(parents.lane, 0));
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
      const S part = select(given, packsOf<S>(value)[k], S(0));
      to[k] += parents.lane < 0 ? part : select(there, sumInAll(part), S(0));
    }
  }
};

}  // namespace dyn::kernels
