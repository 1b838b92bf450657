// SPDX-License-Identifier: BSD-2-Clause
// Visits the bodies of a model, parents first or children first, each with its joint.
#pragma once

#include "kernels/body/shapes.hpp"
#include "kernels/body/workspace.hpp"
#include "kernels/order/body_order.hpp"
#include "kernels/pack/in_memory.hpp"

#include <tuple>
#include <utility>

namespace dyn::kernels {

// Bodies pass values on in a sweep. Each value lies in an array by body: order.forward(passing(arrays...), body), and likewise backward.

template <class... T>
std::tuple<T*...> passing(T*... arrays) {
  return {arrays...};
}

/// Access to one array during a sweep, at body i.
template <class Order, class T>
class FromParent {
 public:
  FromParent(const Order& order, T* array, int i) : order_(order), array_(array), i_(i) {}
  /// Moves on to body i.
  void begin(const Order&, int i, bool) { i_ = i; }
  /// The parent's value.
  decltype(auto) get() const { return order_.parent(array_, i_); }
  /// Leaves x for the children. A value from get() must not be used afterwards.
  void leave(const T& x) const { array_[i_] = x; }

 private:
  const Order& order_;
  T* array_;
  int i_;
};
template <class Order, class T>
class FromChildren {
 public:
  FromChildren(const Order& order, T* array, int i) : order_(order), array_(array), i_(i) {}
  void begin(const Order&, int i, bool) { i_ = i; }
  void putAway(const Order&, int) {}
  /// The sum of what the children gave and of the body's own value.
  T with(const T& own) const {
    T sum = own;
    if (!order_.isLeaf(i_)) sum += array_[i_];
    order_.unite(i_, sum);
    return sum;
  }
  /// The same sum, which also stays in the array.
  const T& gather(const T& own) const {
    T& sum = array_[i_];
    if (order_.isLeaf(i_)) {
      sum = own;
    } else {
      sum += own;
    }
    order_.unite(i_, sum);
    return sum;
  }
  /// The sum of what the children gave. Leaves get the world's entry, so the array must have zeros there, and roots must give nothing.
  const T& given() const { return array_[order_.isLeaf(i_) ? 0 : i_]; }
  /// gather() part by part: fill(put) calls put(part, x) for each member of T. If the lanes are states, a part is written directly to the array.
  template <class Fill>
  const T& gatherInParts(Fill&& fill) const {
    if constexpr (Order::lanes_are_states) {
      T& sum = array_[i_];
      const bool leaf = order_.isLeaf(i_);
      fill([&]<class Part>(Part T::*part, const Part& x) {
        if (leaf) {
          sum.*part = x;
        } else {
          sum.*part += x;
        }
      });
      return readAgain(order_, sum);
    } else {
      T own;
      fill([&]<class Part>(Part T::*part, const Part& x) { own.*part = x; });
      return gather(own);
    }
  }
  /// Gives x to the parent. A root's parent is the world.
  void give(const T& x) const { order_.handOver(array_, i_, x); }
  /// give() of the value that fill(x) writes. If the lanes are states, fill() writes directly to the array where it can.
  template <class Fill>
  void giveInPlace(Fill&& fill) const {
    if constexpr (Order::lanes_are_states) {
      Unwritten<T> room;
      const bool begins = order_.isLastChild(i_);
      T& to = begins ? array_[order_.parentOf(i_)] : *room;
      fill(to);
      if (!begins) give(readAgain(order_, to));
    } else {
      T x;
      fill(x);
      give(x);
    }
  }

 private:
  const Order& order_;
  T* array_;
  int i_;
};

/// A joint's rows of the mass matrix, and the root path of its body.
template <class Order, class S>
class BodyEntry {
 public:
  BodyEntry(const Order& bodies, S* M, int i, int iv) : bodies_(bodies), M_(M), from_(i), to_(i), row_(iv), column_(iv) {}
  /// Calls turning(offset, column, enter) for each body of a contiguous run of revolute joints, and step(*this) for other bodies. `offset` is null
  /// where there is none. There is one root path only, so nothing begins again.
  template <class Begin, class Step, class Turning>
  void climb(Begin&&, Step&& step, Turning&& turning) {
    const std::ptrdiff_t n = bodies_.m.nvx;
    do {
      from_ = to_;
      to_ = bodies_.parentOf(from_);
      const BodyIndex& x = bodies_.index(to_);
      column_ = x.idx_v;
      if (x.contiguous_from > to_) {
        bodies_.reaches(to_);
        step(std::as_const(*this));
        continue;
      }
      const auto offsetOf = [&](int i) { return bodies_.hasOffset(i) ? bodies_.w.r + i : nullptr; };
      const Vec3<S>* offset = offsetOf(from_);
      const DofFactor<S>* dof = bodies_.w.dof + column_;
      S *above = M_ + row_ * n + column_, *below = M_ + column_ * n + row_;
      for (;; --to_, --dof, --above, below -= n) {
        bodies_.reaches(to_);
        turning(offset, dof->column, [&](int k, const S& value) { above[k * n] = below[k] = value; });
        if (to_ == x.contiguous_from) break;
        offset = offsetOf(to_);
      }
    } while (!bodies_.isRoot(to_));
  }
  /// The joint offset of the body that the step came from.
  bool hasOffset() const { return bodies_.hasOffset(from_); }
  const Vec3<S>& offset(const Vec3<S>* r) const { return r[from_]; }
  int nv() const { return bodies_.index(to_).nv; }
  bool floatingBase() const { return bodies_.index(to_).floating_base; }
  bool turnsOnly() const { return bodies_.index(to_).turns_only; }
  const Motion<S>& column(const Workspace<S>& workspace, int l) const { return workspace.dof[column_ + l].column; }
  /// Enters the value for degrees of freedom k of the joint and l of the body that was reached, and its mirror image.
  void enter(int k, int l, const S& value) const {
    const std::ptrdiff_t n = bodies_.m.nvx, i = row_ + k, j = column_ + l;
    M_[i * n + j] = M_[j * n + i] = value;
  }
  /// The same for all six degrees of freedom of a floating base.
  void enterFloatingBase(int k, const Force<S>& f) const {
    for (int l = 0; l < 6; ++l) enter(k, l, l < 3 ? f.linear[l] : f.angular[l - 3]);
  }
  /// Calls use(put). put(k, l, value) enters values for two degrees of freedom k and l of the joint itself.
  template <class Use>
  void enterOwn(Use&& use) const {
    use([&](int k, int l, const S& value) { enter(k, l, value); });
  }

 private:
  const Order& bodies_;
  S* M_;
  int from_, to_, row_, column_;
};

/// Visits one body after the other. S is a number, or a pack of states.
template <class S>
struct Bodies {
  /// Whether the pose of one body is all that the next one waits for. Only the chain of products leads to it then: rotations are multiplied without
  /// correction, into w.product, and orthonormalised beside that chain.
  static constexpr bool latency_bound = false;
  /// Whether all lanes have the same constants, and vectors have each coordinate in a pack of its own. Code may then branch on the constants.
  static constexpr bool shared_constants = true;
  /// Whether the lanes are states. Bodies then have so many numbers, and so much work that waits for none of them, that reading the numbers from
  /// memory again is best: readAgain().
  static constexpr bool lanes_are_states = lanes_of<S> > 1;

  const CompactImpl& m;
  Workspace<S>& w;

  const BodyConstants<Real<S>>& numberConstants(int i) const { return m.constantsIn<Real<S>>()[static_cast<std::size_t>(i)]; }
  /// Constants of body i. For packs of states they are copied to every lane.
  decltype(auto) constants(int i) const {
    const BodyConstants<Real<S>>& c = numberConstants(i);
    if constexpr (std::is_same_v<S, Real<S>>) {
      return (c);
    } else {
      return broadcast<S>(c);
    }
  }
  /// Constants of body i in the order of the lanes, if the states in the lanes are of different models; otherwise null.
  const InertiaConstants<S>* ownInertia(int i) const
    requires lanes_are_states
  {
    return w.inertias ? w.inertias + i : nullptr;
  }
  S armature(int dof) const { return m.armature.empty() ? S(0) : S(static_cast<Real<S>>(m.armature[static_cast<std::size_t>(dof)])); }
  Vec3<S> gravity() const { return cast<S>(m.gravity); }
  bool isRoot(int i) const { return parentOf(i) == 0; }
  /// Whether the body's origin is elsewhere than its parent's.
  bool hasOffset(int i) const { return index(i).offset_axes != 0; }

  template <class T>
  const T& parent(const T* array, int i) const {
    return array[parentOf(i)];
  }
  /// Adds to the parent's entry. The first child to come begins the sum. Entries of leaves stay unchanged.
  template <class T>
  void handOver(T* array, int i, const T& value) const {
    T& sum = array[parentOf(i)];
    if (isLastChild(i)) {
      sum = value;
    } else {
      sum += value;
    }
  }
  bool isLeaf(int i) const { return index(i).leaf; }

  /// Does nothing here. In lane groups a body may be in several lanes, and each of them takes their sum.
  template <class T>
  void unite(int, T&) const {}

  /// The scalar of the mass matrix's entries.
  using Entries = S;
  BodyEntry<Bodies, S> entry(S* M, int i, int iv) const { return {*this, M, i, iv}; }
  /// Code that moves from body to body on its own calls this at body i.
  void reaches(int) const {}
  /// Calls use(dof) for the degrees of freedom in [first, end).
  template <class Use>
  void eachDof(int first, int end, Use&& use) const {
    for (int dof = first; dof < end; ++dof) use(dof);
  }

  /// Calls body(joint, i, idx_v, from...) for each body, parents first. joint is one of the shapes, and `from` are FromParent for each array.
  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (const Run& run : m.runs)
      withShape<S>(run.shape, run.nv, [&]<class Joint>() {
        const int v0 = index(run.first).idx_v, nv = nvOf<Joint>(*this, run.first);
        for (int k = 0; k < run.count; ++k) {
          const Slot<S> slot = slotOf(run, k);
          std::apply([&](T*... x) { body(Joint(slot), run.first + k, v0 + k * nv, FromParent<Bodies, T>(*this, x, run.first + k)...); }, arrays);
        }
      });
  }
  /// Calls body(joint, i, idx_v, from...) for each body, children first. `from` are FromChildren for each array.
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (auto run = m.runs.rbegin(); run != m.runs.rend(); ++run)
      withShape<S>(run->shape, run->nv, [&]<class Joint>() {
        const int v0 = index(run->first).idx_v, nv = nvOf<Joint>(*this, run->first);
        for (int k = run->count - 1; k >= 0; --k) {
          const Slot<S> slot = slotOf(*run, k);
          std::apply([&](T*... x) { body(Joint(slot), run->first + k, v0 + k * nv, FromChildren<Bodies, T>(*this, x, run->first + k)...); }, arrays);
        }
      });
  }

  /// Visits the bodies on the root paths of the degrees of freedom in [first, end), children first. It calls along.operator()<Joint>(each) for each
  /// run of them. each(visit) calls visit(i, idx_v) for the bodies of the run and returns whether there are more runs.
  template <class Along>
  void climb(int first, int end, Along&& along) const {
    int body = m.dof_body[static_cast<std::size_t>(end - 1)];
    const auto next = [&](int i) {
      if (end - first == 1) return parentOf(i);
      do --i;
      while (i > 0 && dofEnd(i) <= first);
      return i;
    };
    auto run = m.runs.rbegin();
    while (body > 0) {
      while (run->first > body) ++run;
      withShape<S>(run->shape, run->nv, [&]<class Joint>() {
        along.template operator()<Joint>([&](auto&& visit) {
          const int run_first = run->first, v0 = index(run_first).idx_v, nv = nvOf<Joint>(*this, run_first);
          int i = body;
          for (; i >= run_first; i = next(i)) visit(i, v0 + (i - run_first) * nv);
          body = i;
          return i > 0;
        });
      });
    }
  }

  Slot<S> slotOf(const Run& run, int k) const {
    const JointMemory<S>& b = w.joints[run.batch];
    const int i = run.slot + k;
    if (run.shape == Shape::dense_constant) {
      const int offset = m.subspace_offset[static_cast<std::size_t>(run.first + k)];
      return {b.pose + i, nullptr, 0, m.subspacesIn<Real<S>>().data() + offset, nullptr, b.stride, run.nv};
    }
    return {b.pose + i, b.subspace ? b.subspace + i : nullptr, b.stride, nullptr, b.bias ? b.bias + i : nullptr, b.stride, run.nv};
  }

  const BodyIndex& index(int i) const { return m.index[static_cast<std::size_t>(i)]; }
  int parentOf(int i) const { return index(i).parent; }
  int depth(int i) const { return index(i).depth; }
  int nv(int i) const { return index(i).nv; }
  /// One past the last degree of freedom of body i's subtree.
  int dofEnd(int i) const { return m.dof_end[static_cast<std::size_t>(index(i).idx_v)]; }
  /// Whether body i is its parent's last child, and so the first one in a backward sweep.
  bool isLastChild(int i) const { return index(i).last_child; }
  /// Whether body i has other children than i + 1.
  bool branches(int i) const { return index(i).branches; }
};

/// Whether body i is a free body on the world. The world neither turns nor accelerates.
template <class Joint, class Order>
bool isFloatingBase(const Order& order, int i) {
  return Joint::is_free && order.isRoot(i);
}

/// A body's angular velocity, from its parent's and its joint's.
template <class Joint, class S>
Vec3<S> turnedBy(const Vec3<S>& parent, const Motion<S>& joint) {
  if constexpr (Joint::has_angular) {
    return parent + joint.angular;
  } else {
    return parent;
  }
}

/// Pose of a body in its parent's frame. It is returned by value, because reading as a vector what was written number by number stalls the core.
template <class S, class Joint>
SE3<S> placedInParent(const Joint& joint, const SE3<S>& placement) {
  SE3<S> rel{joint.rotate(placement.R), placement.p};
  if constexpr (Joint::moves_origin) rel.p += placement.R * joint.translation();
  return rel;
}

/// Orthonormalises a product of rotations by one Newton step of the polar decomposition, R - R (R^T R - 1) / 2 (Higham 1986).
/// A matrix that is not quite a rotation makes inertias grow or shrink, and a pivot has its error four times.
template <class S>
Mat3<S> orthonormalised(const Mat3<S>& R) {
  const Vec3<S> x = R.col(0), y = R.col(1), z = R.col(2);
  const S half(0.5);
  const S xx = half * (dot(x, x) - S(1)), yy = half * (dot(y, y) - S(1)), zz = half * (dot(z, z) - S(1));
  const S xy = half * dot(x, y), xz = half * dot(x, z), yz = half * dot(y, z);
  Mat3<S> out;
  for (int i = 0; i < 3; ++i) {
    out(i, 0) = x[i] - (x[i] * xx + y[i] * xy + z[i] * xz);
    out(i, 1) = y[i] - (x[i] * xy + y[i] * yy + z[i] * yz);
    out(i, 2) = z[i] - (x[i] * xz + y[i] * yz + z[i] * zz);
  }
  return out;
}

}  // namespace dyn::kernels
