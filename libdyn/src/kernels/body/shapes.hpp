// SPDX-License-Identifier: BSD-2-Clause
// The joint shapes as the recursions see them. Each shape knows its sparsity at compile time and has these functions:
//   rotate(E)       returns E times the joint's rotation. Shapes whose rotation is arbitrary also have rotation().
//   translation()   returns the moving frame's origin in the joint frame.
//   times(v)        returns S v in the moving frame; column(k) returns a column of S; project(f, tau) sets tau = S^T f.
//   timesIn(E, v)   returns S v in the axes that E leads to, and columnIn(E, k) a column of S in these axes. Neither multiplies with the zeros of S.
//                   Compilers cannot remove such products, because 0 x may be NaN.
//   bias()          returns (dS/dt) v in the moving frame, where has_bias.
//   direction(k)    returns the index of the unit vector that column(k) is. Only shapes whose columns are all unit vectors have it.
#pragma once

#include <dyn/joint/shape.hpp>
#include <dyn/scalar/select.hpp>
#include <dyn/spatial/inertia.hpp>

#include <cstddef>

namespace dyn::kernels {

/// Where one joint's results lie. Component c is at [c * stride].
template <class S>
struct Slot {
  const S* pose;
  const S* subspace;  ///< of dense shapes
  std::ptrdiff_t subspace_stride;
  const Real<S>* constant_subspace;  ///< of dense_constant shapes: 6 numbers per column
  const S* bias;
  std::ptrdiff_t stride;
  int nv;
};

template <class S>
Mat3<S> loadMatrix(const S* p, std::ptrdiff_t stride) {
  Mat3<S> R;
  for (int i = 0; i < 9; ++i) R.m[i] = p[i * stride];
  return R;
}
template <class S>
Vec3<S> loadVector(const S* p, std::ptrdiff_t stride) {
  return {p[0], p[stride], p[2 * stride]};
}
/// E Rz(c, s).
template <class S>
Mat3<S> turnZ(const Mat3<S>& E, const S& c, const S& s) {
  Mat3<S> R;
  for (int i = 0; i < 3; ++i) {
    R(i, 0) = E(i, 0) * c + E(i, 1) * s;
    R(i, 1) = E(i, 1) * c - E(i, 0) * s;
    R(i, 2) = E(i, 2);
  }
  return R;
}

template <class S>
struct Revolute {
  static constexpr int nv = 1;
  static constexpr bool moves_origin = false, has_linear = false, has_angular = true, has_bias = false, is_free = false, about_z = true;
  S c, s;
  explicit Revolute(const Slot<S>& slot) : c(slot.pose[0]), s(slot.pose[slot.stride]) {}
  Mat3<S> rotate(const Mat3<S>& E) const { return turnZ(E, c, s); }
  Vec3<S> translation() const { return {}; }
  Motion<S> times(const S* v) const { return {{}, {S(0), S(0), v[0]}}; }
  static constexpr int direction(int) { return 5; }
  Motion<S> column(int) const { return {{}, {S(0), S(0), S(1)}}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {{}, v[0] * E.col(2)}; }
  Motion<S> columnIn(const Mat3<S>& E, int) const { return {{}, E.col(2)}; }
  void project(const Force<S>& f, S* tau) const { tau[0] = f.angular[2]; }
  Motion<S> bias() const { return {}; }
};

template <class S>
struct Prismatic {
  static constexpr int nv = 1;
  static constexpr bool moves_origin = true, has_linear = true, has_angular = false, has_bias = false, is_free = false, about_z = false;
  S z;
  explicit Prismatic(const Slot<S>& slot) : z(slot.pose[0]) {}
  Mat3<S> rotate(const Mat3<S>& E) const { return E; }
  Vec3<S> translation() const { return {S(0), S(0), z}; }
  Motion<S> times(const S* v) const { return {{S(0), S(0), v[0]}, {}}; }
  static constexpr int direction(int) { return 2; }
  Motion<S> column(int) const { return {{S(0), S(0), S(1)}, {}}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {v[0] * E.col(2), {}}; }
  Motion<S> columnIn(const Mat3<S>& E, int) const { return {E.col(2), {}}; }
  void project(const Force<S>& f, S* tau) const { tau[0] = f.linear[2]; }
  Motion<S> bias() const { return {}; }
};

template <class S>
void addAt(Vec3<S>& v, int k, const S& x) {
  v[k] += x;
}
/// Adds a x b. For packs it adds one product after the other, so that all of them become fused multiply-adds.
template <class S>
void addCross(Vec3<S>& sum, const Vec3<S>& a, const Vec3<S>& b) {
  if constexpr (lanes_of<S> == 1) {
    sum += cross(a, b);
  } else {
    sum.x += a.y * b.z;
    sum.y += a.z * b.x;
    sum.z += a.x * b.y;
    sum.x -= a.z * b.y;
    sum.y -= a.x * b.z;
    sum.z -= a.y * b.x;
  }
}
/// v x (0, 0, z).
template <class S>
Vec3<S> crossZ(const Vec3<S>& v, const S& z) {
  return {v.y * z, -(v.x * z), S(0)};
}
template <class S>
Vec3<S> unit(int k) {
  Vec3<S> e{};
  addAt(e, k, S(1));
  return e;
}

template <class S>
struct Spherical {
  static constexpr int nv = 3;
  static constexpr bool moves_origin = false, has_linear = false, has_angular = true, has_bias = false, is_free = false, about_z = false;
  Mat3<S> R;
  explicit Spherical(const Slot<S>& slot) : R(loadMatrix(slot.pose, slot.stride)) {}
  const Mat3<S>& rotation() const { return R; }
  Mat3<S> rotate(const Mat3<S>& E) const { return E * R; }
  Vec3<S> translation() const { return {}; }
  Motion<S> times(const S* v) const { return {{}, {v[0], v[1], v[2]}}; }
  static constexpr int direction(int k) { return 3 + k; }
  Motion<S> column(int k) const { return {{}, unit<S>(k)}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {{}, E * Vec3<S>{v[0], v[1], v[2]}}; }
  Motion<S> columnIn(const Mat3<S>& E, int k) const { return {{}, E.col(k)}; }
  void project(const Force<S>& f, S* tau) const {
    for (int k = 0; k < 3; ++k) tau[k] = f.angular[k];
  }
  Motion<S> bias() const { return {}; }
};

template <class S>
struct Translation {
  static constexpr int nv = 3;
  static constexpr bool moves_origin = true, has_linear = true, has_angular = false, has_bias = false, is_free = false, about_z = false;
  Vec3<S> p;
  explicit Translation(const Slot<S>& slot) : p(loadVector(slot.pose, slot.stride)) {}
  Mat3<S> rotate(const Mat3<S>& E) const { return E; }
  Vec3<S> translation() const { return p; }
  Motion<S> times(const S* v) const { return {{v[0], v[1], v[2]}, {}}; }
  static constexpr int direction(int k) { return k; }
  Motion<S> column(int k) const { return {unit<S>(k), {}}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {E * Vec3<S>{v[0], v[1], v[2]}, {}}; }
  Motion<S> columnIn(const Mat3<S>& E, int k) const { return {E.col(k), {}}; }
  void project(const Force<S>& f, S* tau) const {
    for (int k = 0; k < 3; ++k) tau[k] = f.linear[k];
  }
  Motion<S> bias() const { return {}; }
};

template <class S>
struct Planar {
  static constexpr int nv = 3;
  static constexpr bool moves_origin = true, has_linear = true, has_angular = true, has_bias = false, is_free = false, about_z = false;
  S x, y, c, s;
  explicit Planar(const Slot<S>& slot) : x(slot.pose[0]), y(slot.pose[slot.stride]), c(slot.pose[2 * slot.stride]), s(slot.pose[3 * slot.stride]) {}
  Mat3<S> rotate(const Mat3<S>& E) const { return turnZ(E, c, s); }
  Vec3<S> translation() const { return {x, y, S(0)}; }
  Motion<S> times(const S* v) const { return {{v[0], v[1], S(0)}, {S(0), S(0), v[2]}}; }
  static constexpr int direction(int k) { return k < 2 ? k : 5; }
  Motion<S> column(int k) const { return k < 2 ? Motion<S>{unit<S>(k), {}} : Motion<S>{{}, unit<S>(2)}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {v[0] * E.col(0) + v[1] * E.col(1), v[2] * E.col(2)}; }
  Motion<S> columnIn(const Mat3<S>& E, int k) const { return k < 2 ? Motion<S>{E.col(k), {}} : Motion<S>{{}, E.col(2)}; }
  void project(const Force<S>& f, S* tau) const {
    tau[0] = f.linear[0];
    tau[1] = f.linear[1];
    tau[2] = f.angular[2];
  }
  Motion<S> bias() const { return {}; }
};

template <class S>
struct Free {
  static constexpr int nv = 6;
  static constexpr bool moves_origin = true, has_linear = true, has_angular = true, has_bias = false, is_free = true, about_z = false;
  Mat3<S> R;
  Vec3<S> p;
  explicit Free(const Slot<S>& slot) : R(loadMatrix(slot.pose, slot.stride)), p(loadVector(slot.pose + 9 * slot.stride, slot.stride)) {}
  const Mat3<S>& rotation() const { return R; }
  Mat3<S> rotate(const Mat3<S>& E) const { return E * R; }
  Vec3<S> translation() const { return p; }
  Motion<S> times(const S* v) const { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }
  static constexpr int direction(int k) { return k; }
  Motion<S> column(int k) const { return k < 3 ? Motion<S>{unit<S>(k), {}} : Motion<S>{{}, unit<S>(k - 3)}; }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const { return {E * Vec3<S>{v[0], v[1], v[2]}, E * Vec3<S>{v[3], v[4], v[5]}}; }
  Motion<S> columnIn(const Mat3<S>& E, int k) const { return k < 3 ? Motion<S>{E.col(k), {}} : Motion<S>{{}, E.col(k - 3)}; }
  void project(const Force<S>& f, S* tau) const {
    for (int k = 0; k < 3; ++k) {
      tau[k] = f.linear[k];
      tau[3 + k] = f.angular[k];
    }
  }
  Motion<S> bias() const { return {}; }
};

/// Any pose, with a subspace given in numbers, constant or varying. The subspace has one column, or as many as the slot says if NV is 0.
template <class S, int NV, bool Varying>
struct Dense {
  static constexpr int nv = NV;
  static constexpr bool moves_origin = true, has_linear = true, has_angular = true, has_bias = Varying, is_free = false, about_z = false;
  const Slot<S>& slot;
  explicit Dense(const Slot<S>& where) : slot(where) {}
  int count() const { return NV > 0 ? NV : slot.nv; }
  Mat3<S> rotation() const { return loadMatrix(slot.pose, slot.stride); }
  Mat3<S> rotate(const Mat3<S>& E) const { return E * rotation(); }
  Vec3<S> translation() const { return loadVector(slot.pose + 9 * slot.stride, slot.stride); }
  Motion<S> load(const S* p, std::ptrdiff_t stride) const { return {loadVector(p, stride), loadVector(p + 3 * stride, stride)}; }
  Motion<S> column(int k) const {
    if constexpr (Varying) {
      return load(slot.subspace + 6 * k * slot.subspace_stride, slot.subspace_stride);
    } else {
      const Real<S>* c = slot.constant_subspace + 6 * k;
      return {{S(c[0]), S(c[1]), S(c[2])}, {S(c[3]), S(c[4]), S(c[5])}};
    }
  }
  Motion<S> times(const S* v) const {
    Motion<S> m = v[0] * column(0);
    for (int k = 1; k < count(); ++k) m += v[k] * column(k);
    return m;
  }
  Motion<S> timesIn(const Mat3<S>& E, const S* v) const {
    const Motion<S> m = times(v);
    return {E * m.linear, E * m.angular};
  }
  Motion<S> columnIn(const Mat3<S>& E, int k) const {
    const Motion<S> m = column(k);
    return {E * m.linear, E * m.angular};
  }
  void project(const Force<S>& f, S* tau) const {
    for (int k = 0; k < count(); ++k) tau[k] = dot(column(k), f);
  }
  Motion<S> bias() const { return Varying ? load(slot.bias, slot.stride) : Motion<S>{}; }
};

/// Degrees of freedom of a joint. The number is a constant unless the joint's shape counts them at run time.
template <class Joint>
int nvOf(const Joint& joint) {
  if constexpr (Joint::nv > 0) {
    return Joint::nv;
  } else {
    return joint.count();
  }
}
/// The same for the joint that moves body i.
template <class Joint, class Order>
int nvOf(const Order& order, int i) {
  if constexpr (Joint::nv > 0) {
    return Joint::nv;
  } else {
    return order.nv(i);
  }
}
/// The largest number of degrees of freedom that joints of this shape have.
template <class Joint>
constexpr int most_nv = Joint::nv > 0 ? Joint::nv : max_joint_nv;

// Everything that is called for a run's shape is inlined. A step is only a few instructions, but compilers would judge it by its lines of code.
// Sanitized code is not inlined, because it would grow too much. Code on scalars whose operations are calls is not inlined either.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || defined(DYN_PLAIN_LOOPS)
#define DYN_FLATTEN
#else
#define DYN_FLATTEN __attribute__((flatten))
#endif

template <class Joint, class Kernel>
DYN_FLATTEN __attribute__((noinline)) void inOneFunction(Kernel& kernel) {
  kernel.template operator()<Joint>();
}
template <class Joint, class Kernel>
__attribute__((noinline)) void inCalls(Kernel& kernel) {
  kernel.template operator()<Joint>();
}

/// Calls a kernel with the shape of a run: `kernel.template operator()<Shape>()`. This is the only dispatch of a run. Shapes that are rare in robots
/// are not inlined as a whole, because inlining takes most of the compile time.
/// Without `constants` there are no dense_constant shapes; without `varying` there are no dense ones.
template <class S, bool constants = true, bool varying = true, class Kernel>
void withShape(Shape shape, int nv, Kernel&& kernel) {
  [[maybe_unused]] const auto dense = [&]<bool varies>() {
    if (nv == 1) return inOneFunction<Dense<S, 1, varies>>(kernel);
    return inCalls<Dense<S, 0, varies>>(kernel);
  };
  switch (shape) {
    case Shape::revolute:
      return inOneFunction<Revolute<S>>(kernel);
    case Shape::prismatic:
      return inOneFunction<Prismatic<S>>(kernel);
    case Shape::spherical:
      return inOneFunction<Spherical<S>>(kernel);
    case Shape::translation:
      return inCalls<Translation<S>>(kernel);
    case Shape::planar:
      return inCalls<Planar<S>>(kernel);
    case Shape::free:
      return inOneFunction<Free<S>>(kernel);
    case Shape::dense_constant:
    case Shape::dense:
      break;
  }
  if constexpr (constants)
    if (shape == Shape::dense_constant) return dense.template operator()<false>();
  if constexpr (varying)
    if (shape == Shape::dense) return dense.template operator()<true>();
}

}  // namespace dyn::kernels
