// What bodies hand on, kept in registers where the next one visited is the one to get it, which along a limb it is: through memory it would
// come late.
#pragma once

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
template <class From>
class KeptFromChildren;
template <class T>
class KeptFromChildren<Added<T>> {
 public:
  template <class Order>
  KeptFromChildren(const Order&, Added<T> from, int) : array_(from.array) {}
  template <class Order>
  void begin(const Order&, int i, bool) {
    sum_ = array_[i];
    sum_ += kept_;
    array_[i] = sum_;
  }
  T get() const { return sum_; }
  void give(const T& x) { kept_ = x; }
  /// To where the parent looks for it.
  template <class Order>
  void putAway(const Order& order, int i) {
    if (!order.isRoot(i)) order.addToParent(array_, i, kept_);
    kept_ = T{};
  }

 private:
  T* array_;
  T kept_{}, sum_{};
};
template <class T>
class KeptFromChildren<Handed<T>> {
 public:
  template <class Order>
  KeptFromChildren(const Order&, Handed<T> from, int) : array_(from.array) {}
  template <class Order>
  void begin(const Order& order, int i, bool kept) {
    if (order.isLeaf(i)) return;
    if (!kept) {
      kept_ = array_[i];
    } else if (!order.isOnlyChild(i + 1)) {
      kept_ = kept_ + array_[i];
    }
  }
  T get() const { return kept_; }
  void give(const T& x) { kept_ = x; }
  template <class Order>
  void putAway(const Order& order, int i) {
    if (!order.isRoot(i)) order.handOver(array_, i, kept_);
  }

 private:
  T* array_;
  T kept_{};
};

/// What the order keeps, and what it does not.
template <class Order, class T>
using ParentOf = std::conditional_t<Order::template keeps<T>, KeptFromParent<T>, FromParent<Order, T>>;
template <class Order, class From>
using ChildrenOf = std::conditional_t<Order::template keeps<typename From::Type>, KeptFromChildren<From>, FromChildren<Order, From>>;

/// Calls step(i, from...) for i from `first` on and before `end`, all of one run.
template <class Order, class Step, class... T>
void forwardKeeping(const Order& order, int first, int end, std::tuple<T*...> arrays, Step&& step) {
  auto from = std::apply([&](T*... x) { return std::tuple<ParentOf<Order, T>...>(ParentOf<Order, T>(order, x, first)...); }, arrays);
  for (int i = first; i < end; ++i)
    std::apply(
        [&](auto&... x) {
          (x.begin(order, i, i > first && order.goesOn(i)), ...);
          step(i, x...);
        },
        from);
}
/// The other way.
template <class Order, class Step, class... From>
void backwardKeeping(const Order& order, int first, int end, std::tuple<From...> arrays, Step&& step) {
  auto from = std::apply([&](From... x) { return std::tuple<ChildrenOf<Order, From>...>(ChildrenOf<Order, From>(order, x, first)...); }, arrays);
  for (int i = end - 1; i >= first; --i)
    std::apply(
        [&](auto&... x) {
          (x.begin(order, i, i < end - 1 && order.goesBack(i + 1)), ...);
          step(i, x...);
          if (i == first || !order.goesBack(i)) (x.putAway(order, i), ...);
        },
        from);
}

}  // namespace dyn::kernels
