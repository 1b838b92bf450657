// SPDX-License-Identifier: BSD-2-Clause
// Caches in registers what a body passes to its neighbour, where that is the next body visited, as along a limb. Through memory it would arrive
// late.
#pragma once

#include "kernels/order/sweep.hpp"
#include "kernels/pack/lanes.hpp"

#include <tuple>
#include <type_traits>

namespace dyn::kernels {

/// FromParent with its value cached throughout a run.
template <class T>
class CachedFromParent {
 public:
  template <class Order>
  CachedFromParent(const Order&, T* array, int) : array_(array) {}
  template <class Order>
  void begin(const Order& order, int i, bool cached) {
    i_ = i;
    if (!cached) value_ = order.parent(array_, i);
  }
  T get() const { return value_; }
  void leave(const T& x) {
    array_[i_] = x;
    value_ = x;
  }

 private:
  T* array_;
  T value_{};
  int i_ = 0;
};

/// FromChildren with its value cached throughout a run.
template <class Order, class T>
class CachedFromChildren {
 public:
  CachedFromChildren(const Order& order, T* array, int) : order_(order), array_(array) {}
  void begin(const Order&, int i, bool cached) {
    i_ = i;
    if (cached) {
      if (order_.branches(i)) cached_ += array_[i];
    } else if (order_.isLeaf(i)) {
      cached_ = T{};
    } else {
      cached_ = array_[i];
    }
  }
  T with(const T& own) const {
    T sum = own;
    sum += cached_;
    order_.unite(i_, sum);
    return sum;
  }
  const T& given() const { return cached_; }
  T gather(const T& own) const {
    T sum = with(own);
    array_[i_] = sum;
    return sum;
  }
  template <class Fill>
  T gatherInParts(Fill&& fill) const {
    T own;
    fill([&]<class Part>(Part T::*part, const Part& x) { own.*part = x; });
    return gather(own);
  }
  void give(const T& x) { cached_ = x; }
  template <class Fill>
  void giveInPlace(Fill&& fill) {
    fill(cached_);
  }
  /// Writes the cached value to where the parent reads it.
  void putAway(const Order&, int i) {
    if (!order_.isRoot(i)) order_.handOver(array_, i, cached_);
  }

 private:
  const Order& order_;
  T* array_;
  T cached_{};
  int i_ = 0;
};

/// The cached class if the order caches T, otherwise the plain one.
template <class Order, class T>
using ParentOf = std::conditional_t<Order::template caches<T>, CachedFromParent<T>, FromParent<Order, T>>;
template <class Order, class T>
using ChildrenOf = std::conditional_t<Order::template caches<T>, CachedFromChildren<Order, T>, FromChildren<Order, T>>;

/// Calls step(i, from...) for the bodies i in [first, end), all of one run, parents first.
template <class Order, class Step, class... T>
void forwardCached(const Order& order, int first, int end, std::tuple<T*...> arrays, Step&& step) {
  auto from = std::apply([&](T*... x) { return std::tuple<ParentOf<Order, T>...>(ParentOf<Order, T>(order, x, first)...); }, arrays);
  for (int i = first; i < end; ++i)
    std::apply(
        [&](auto&... x) {
          [[maybe_unused]] const bool cached = order.goesOn(i, first);  // an order may pass no arrays
          (x.begin(order, i, cached), ...);
          step(i, x...);
        },
        from);
}
/// The same, children first.
template <class Order, class Step, class... T>
void backwardCached(const Order& order, int first, int end, std::tuple<T*...> arrays, Step&& step) {
  auto from = std::apply([&](T*... x) { return std::tuple<ChildrenOf<Order, T>...>(ChildrenOf<Order, T>(order, x, first)...); }, arrays);
  bool cached = false;
  for (int i = end - 1; i >= first; --i)
    std::apply(
        [&](auto&... x) {
          (x.begin(order, i, cached), ...);
          step(i, x...);
          cached = order.goesBack(i, first);
          if (!cached) (x.putAway(order, i), ...);
        },
        from);
}

/// Visits one body after the other, and caches in registers the values that bodies pass on.
template <class S>
struct CachedBodies : Bodies<S> {
  template <class T>
  static constexpr bool caches = lanes_of<S> == 1 || fits_registers<S, T>;
  /// Whether body i - 1 is the parent of body i and in the same run.
  bool goesOn(int i, int) const { return this->index(i).follows; }
  /// Whether body i passes its values to body i - 1.
  bool goesBack(int i, int first) const { return goesOn(i, first); }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const Run& run : this->m.runs)
      overRun(run, body, [&](const auto& step) { forwardCached(*this, run.first, run.first + run.count, arrays, step); });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = this->m.runs.rbegin(); run != this->m.runs.rend(); ++run)
      overRun(*run, body, [&](const auto& step) { backwardCached(*this, run->first, run->first + run->count, arrays, step); });
  }

 private:
  /// Calls walk(step), where step(i, from...) calls body(joint, i, idx_v, from...).
  template <class Body, class Walk>
  void overRun(const Run& run, Body&& body, Walk&& walk) const {
    withShape<S>(run.shape, run.nv, [&]<class Joint>() {
      const int v0 = this->index(run.first).idx_v, nv = nvOf<Joint>(*this, run.first);
      walk([&](int i, auto&... from) {
        const int k = i - run.first;
        const Slot<S> slot = this->slotOf(run, k);
        body(Joint(slot), i, v0 + k * nv, from...);
      });
    });
  }
};

}  // namespace dyn::kernels
