// Walking the bodies with vectors in registers.
#pragma once

#include "kernels/vectored.hpp"
// Specialisations come before what is made of them.
#include "kernels/kept.hpp"

namespace dyn::kernels {

/// With what bodies hand on in registers.
struct KeepingBodies : Bodies<Vectored> {
  template <class T>
  static constexpr bool keeps = true;
  /// To body i from i - 1, its parent.
  bool goesOn(int i) const { return parentOf(i) == i - 1; }
  /// From body i to i - 1.
  bool goesBack(int i) const { return parentOf(i) == i - 1; }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const Run& run : m.runs)
      withShape<Vectored>(run.shape, run.nv, [&]<class Joint>() DYN_RUN_LOOP {
        const int v0 = index(run.first).idx_v;
        const auto step = [&](int i, auto&... from) {
          const int k = i - run.first;
          const Slot<Vectored> slot = slotOf(run, k);
          body(Joint(slot), i, v0 + k * Joint::nv, from...);
        };
        forwardKeeping(*this, run.first, run.first + run.count, arrays, step);
      });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = m.runs.rbegin(); run != m.runs.rend(); ++run)
      withShape<Vectored>(run->shape, run->nv, [&]<class Joint>() DYN_RUN_LOOP {
        const int v0 = index(run->first).idx_v;
        const auto step = [&](int i, auto&... from) {
          const int k = i - run->first;
          const Slot<Vectored> slot = slotOf(*run, k);
          body(Joint(slot), i, v0 + k * Joint::nv, from...);
        };
        backwardKeeping(*this, run->first, run->first + run->count, arrays, step);
      });
  }
};

/// Where constants are what vectors are multiplied by, on the right: they stay single numbers in memory, from which they get into all lanes at
/// no cost.
struct AlignedBodies : KeepingBodies {
  static constexpr bool waits = true;
  const BodyConstants<double>& constants(int i) const { return m.constants[static_cast<std::size_t>(i)]; }
};

}  // namespace dyn::kernels
