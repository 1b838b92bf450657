// Walking the strips of a model, four joints in the lanes of a pack, as Bodies walks its bodies.
#pragma once

#include "kernels/kept.hpp"
#include "kernels/shapes.hpp"
#include "kernels/strip_entry.hpp"

namespace dyn::kernels {

/// `varying`: also of joints whose subspace varies with q.
template <class S, bool varying = true>
struct Strips {
  static constexpr bool waits = false, alike = false, streams = false;

  const CompactImpl& m;
  Workspace<S>& w;

  const BodyConstants<S>& constants(int i) const { return reinterpret_cast<const BodyConstants<S>*>(m.strips.constants.data())[i]; }
  S armature(int dof) const { return S::load(m.strips.armature.data() + strip_lanes * dof); }
  Vec3<S> gravity() const { return cast<S>(m.gravity); }
  bool isRoot(int i) const { return strip(i).depth == 1; }
  bool hasLever(int) const { return true; }

  /// What the parents have, in the lanes of their children.
  template <class T>
  T parent(const T* array, int i) const {
    const Strip& s = strip(i);
    if (s.aligned) return array[s.parents[0].strip];
    if (s.apart) {
      const double* first[strip_lanes];
      for (int l = 0; l < strip_lanes; ++l) first[l] = reinterpret_cast<const double*>(array + s.lane_parents[l].strip) + s.lane_parents[l].lane;
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
  /// Adds to what the parents have been handed, which begins with the first child's. Leaves keep what they had.
  template <class T>
  void handOver(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (s.gives_all && s.parents[0].first) {
      array[s.parents[0].strip] = value;
      return;
    }
    for (int p = 0; p < s.parents_count; ++p)
      if (s.parents[p].first) array[s.parents[p].strip] = T{};
    addToParent(array, i, value);
  }
  bool isLeaf(int i) const { return strip(i).leaf; }
  int nv(int i) const { return strip(i).nv; }
  template <class T>
  static constexpr bool keeps = fits_registers<S, T>;
  /// To strip i from i - 1, which has all its parents, lane by lane.
  bool goesOn(int i, int first) const { return i > first && strip(i).aligned && strip(i).parents[0].strip == i - 1; }
  /// From strip i to i - 1, all there is to give.
  bool goesBack(int i, int first) const { return i > first && strip(i).gives_all && strip(i).parents[0].strip == i - 1; }
  /// Whether others than i + 1, which gives all of its to strip i, give to it as well.
  bool branches(int i) const { return !strip(i + 1).parents[0].first; }
  /// What is in several lanes of one body: its sum, in each of them.
  template <class T>
  void unite(int i, T& value) const {
    const Strip& s = strip(i);
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
  using Entry = StripEntry<S>;
  Entry entry(double* M, int i, int) const { return {m, M, i}; }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const StripRun& run : m.strips.runs)
      withShape<S, false, varying>(run.shape, run.nv, [&]<class Joint>() {
        const auto step = [&](int i, auto&... from) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, strip(i).dof, from...);
        };
        forwardKeeping(*this, run.first, run.end, arrays, step);
      });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = m.strips.runs.rbegin(); run != m.strips.runs.rend(); ++run)
      withShape<S, false, varying>(run->shape, run->nv, [&]<class Joint>() {
        const auto step = [&](int i, auto&... from) {
          const Slot<S> slot = slotOf(i);
          body(Joint(slot), i, strip(i).dof, from...);
        };
        backwardKeeping(*this, run->first, run->end, arrays, step);
      });
  }

 private:
  template <class T>
  void addToParent(T* array, int i, const T& value) const {
    const Strip& s = strip(i);
    if (s.gives_all) {
      array[s.parents[0].strip] += value;
    } else if (packs_in<S, T> <= 6 && s.apart) {
      // Forces and the like; measured: written number by number, articulated inertias slow all strips of aba down.
      const T given = value;
      for (int l = 0; l < strip_lanes; ++l) {
        const LaneParent& parent = s.lane_parents[l];
        if (!parent.given) continue;
        double* to = reinterpret_cast<double*>(array + parent.strip) + parent.lane;
        const double* from = reinterpret_cast<const double*>(&given) + l;
        for (std::size_t k = 0; k < packs_in<S, T>; ++k) to[strip_lanes * k] += from[strip_lanes * k];
      }
    } else {
      for (int p = 0; p < s.parents_count; ++p) give(s.parents[p], array, value);
    }
  }
  const Strip& strip(int i) const { return m.strips.strips[static_cast<std::size_t>(i)]; }
  Slot<S> slotOf(int i) const {
    const Strip& s = strip(i);
    const JointMemory<S>& b = w.joints[s.batch];
    return {b.pose + s.slot, b.subspace ? b.subspace + s.slot : nullptr, b.stride, nullptr, b.bias ? b.bias + s.slot : nullptr, b.stride, s.nv};
  }
  template <class T>
  static T of(const StripParents& parents, const T* array) {
    const T& all = array[parents.strip];
    return parents.lane < 0 ? all : inAllLanes<S>(all, parents.lane);
  }
  template <class T>
  static void give(const StripParents& parents, T* array, const T& value) {
    S* to = packsOf<S>(array[parents.strip]);
    const auto given = lanes<S>(parents.given);
    const auto there = lanes<S>(1U << std::max(parents.lane, 0));
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) {
      const S part = select(given, packsOf<S>(value)[k], S(0));
      to[k] += parents.lane < 0 ? part : select(there, sumInAll(part), S(0));
    }
  }
};

}  // namespace dyn::kernels
