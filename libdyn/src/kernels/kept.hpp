// What bodies hand on, kept in registers where the next one visited is the one to get it, which along a limb it is: through memory it would
// come late.
#pragma once

#include "kernels/lanes.hpp"
#include "kernels/sweep.hpp"

#include <tuple>
#include <type_traits>

namespace dyn::kernels {

/// FromParent, through all of a run.
template <class T>
class KeptFromParent {
 public:
  template <class Order>
  KeptFromParent(const Order&, T* array, int) : array_(array) {}
  template <class Order>
  void begin(const Order& order, int i, bool kept) {
    i_ = i;
    if (!kept) value_ = order.parent(array_, i);
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

/// FromChildren, through all of a run.
template <class Order, class T>
class KeptFromChildren {
 public:
  KeptFromChildren(const Order& order, T* array, int) : order_(order), array_(array) {}
  void begin(const Order&, int i, bool kept) {
    i_ = i;
    if (kept) {
      if (order_.branches(i)) kept_ += array_[i];
    } else if (order_.isLeaf(i)) {
      kept_ = T{};
    } else {
      kept_ = array_[i];
    }
  }
  T with(const T& own) const {
    T sum = own;
    sum += kept_;
    order_.unite(i_, sum);
    return sum;
  }
  const T& given() const { return kept_; }
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
  void give(const T& x) { kept_ = x; }
  template <class Fill>
  void giveInPlace(Fill&& fill) {
    fill(kept_);
  }
  /// To where the parent looks for it.
  void putAway(const Order&, int i) {
    if (!order_.isRoot(i)) order_.handOver(array_, i, kept_);
  }

 private:
  const Order& order_;
  T* array_;
  T kept_{};
  int i_ = 0;
};

/// What the order keeps, and what it does not.
template <class Order, class T>
using ParentOf = std::conditional_t<Order::template keeps<T>, KeptFromParent<T>, FromParent<Order, T>>;
template <class Order, class T>
using ChildrenOf = std::conditional_t<Order::template keeps<T>, KeptFromChildren<Order, T>, FromChildren<Order, T>>;

/// Calls step(i, from...) for i from `first` on and before `end`, all of one run.
template <class Order, class Step, class... T>
void forwardKeeping(const Order& order, int first, int end, std::tuple<T*...> arrays, Step&& step) {
  auto from = std::apply([&](T*... x) { return std::tuple<ParentOf<Order, T>...>(ParentOf<Order, T>(order, x, first)...); }, arrays);
  for (int i = first; i < end; ++i)
    std::apply(
        [&](auto&... x) {
          [[maybe_unused]] const bool kept = order.goesOn(i, first);  // an order may hand on nothing
          (x.begin(order, i, kept), ...);
          step(i, x...);
        },
        from);
}
/// The other way.
template <class Order, class Step, class... T>
void backwardKeeping(const Order& order, int first, int end, std::tuple<T*...> arrays, Step&& step) {
  auto from = std::apply([&](T*... x) { return std::tuple<ChildrenOf<Order, T>...>(ChildrenOf<Order, T>(order, x, first)...); }, arrays);
  bool kept = false;
  for (int i = end - 1; i >= first; --i)
    std::apply(
        [&](auto&... x) {
          (x.begin(order, i, kept), ...);
          step(i, x...);
          kept = order.goesBack(i, first);
          if (!kept) (x.putAway(order, i), ...);
        },
        from);
}

/// One body after the other, with what they hand on in registers.
template <class S>
struct KeepingBodies : Bodies<S> {
  template <class T>
  static constexpr bool keeps = lanes_of<S> == 1 || fits_registers<S, T>;
  /// To body i from i - 1, its parent, in a run from `first` on.
  bool goesOn(int i, int) const { return this->index(i).follows; }
  /// From body i to i - 1.
  bool goesBack(int i, int first) const { return goesOn(i, first); }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const Run& run : this->m.runs)
      overRun(run, body, [&](const auto& step) { forwardKeeping(*this, run.first, run.first + run.count, arrays, step); });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = this->m.runs.rbegin(); run != this->m.runs.rend(); ++run)
      overRun(*run, body, [&](const auto& step) { backwardKeeping(*this, run->first, run->first + run->count, arrays, step); });
  }

 private:
  /// Calls walk(step), step(i, from...) being body(joint, i, idx_v, from...).
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
