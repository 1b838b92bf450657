// SPDX-License-Identifier: BSD-2-Clause
// Rotations and origins for recursions in the joints' own frames. If a joint turns about an axis of its parent, the entries of its rotation are
// c, s, -s, c, one 1 or -1, and zeros, so products with it need few multiplications.
#pragma once

#include "kernels/body/joint_offsets.hpp"
#include "kernels/order/sweep.hpp"

namespace dyn::kernels {

/// The rotation AxisExchange{shift, flips} times Rz(c, s), from a joint's axes to its parent's.
template <class S, int shift, bool flips>
struct ExchangedTurn {
  static constexpr int x = shift, y = (shift + 1) % 3,
                       z = (shift + 2) % 3;  ///< the parent's axes along which the joint's x, y and z lie before it moves
  S c, s;

  ExchangedTurn(const S& cosine, const S& sine) : c(cosine), s(sine) {}

  /// Rz v.
  Vec3<S> turned(const Vec3<S>& v) const { return {c * v.x - s * v.y, s * v.x + c * v.y, v.z}; }
  /// Rz a Rz^T.
  Sym3<S> turned(const Sym3<S>& a) const {
    Sym3<S> b = turnedAboutZ(a.xx, a.xy, a.yy);
    b.xz = c * a.xz - s * a.yz;
    b.yz = s * a.xz + c * a.yz;
    b.zz = a.zz;
    return b;
  }

  static Vec3<S> exchanged(const Vec3<S>& v) {
    Vec3<S> out;
    out[x] = v.x;
    out[y] = flips ? -v.y : v.y;
    out[z] = flips ? -v.z : v.z;
    return out;
  }
  static Mat3<S> exchanged(const Mat3<S>& a) {
    Mat3<S> out;
    constexpr int to[] = {x, y, z};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out(to[i], to[j]) = flips && (i == 0) != (j == 0) ? -a(i, j) : a(i, j);
    return out;
  }
  static Sym3<S> exchanged(const Sym3<S>& a) {
    const Mat3<S> out = exchanged(a.matrix());
    return {out(0, 0), out(0, 1), out(0, 2), out(1, 1), out(1, 2), out(2, 2)};
  }

  friend Vec3<S> firstColumn(const Mat3<S>& A, const ExchangedTurn& R) {
    const Vec3<S> sine = R.s * A.col(y);
    return flips ? R.c * A.col(x) - sine : R.c * A.col(x) + sine;
  }
  friend Vec3<S> lastColumn(const Mat3<S>& A, const ExchangedTurn&) { return flips ? -A.col(z) : A.col(z); }

  friend Mat3<S> operator*(const Mat3<S>& A, const ExchangedTurn& R) {
    const Vec3<S> first = transposeTimes(R, A.row(0)), second = transposeTimes(R, A.row(1)), third = transposeTimes(R, A.row(2));
    return {{first.x, first.y, first.z, second.x, second.y, second.z, third.x, third.y, third.z}};
  }
  friend Vec3<S> operator*(const ExchangedTurn& R, const Vec3<S>& v) { return exchanged(R.turned(v)); }
  friend Sym3<S> congruence(const ExchangedTurn& R, const Sym3<S>& a) { return exchanged(R.turned(a)); }
  friend Sym3<S> planarCongruence(const ExchangedTurn& R, const S& xx, const S& xy, const S& yy) { return exchanged(R.turnedAboutZ(xx, xy, yy)); }
  friend Mat3<S> planarCongruence(const ExchangedTurn& R, const Vec3<S>& by_x, const Vec3<S>& by_y) {
    const Vec3<S> p = R.turned(R.c * by_x - R.s * by_y), q = R.turned(R.s * by_x + R.c * by_y);
    return exchanged(Mat3<S>{{p.x, q.x, S(0), p.y, q.y, S(0), p.z, q.z, S(0)}});
  }
  friend Vec3<S> transposeTimes(const ExchangedTurn& R, const Vec3<S>& v) {
    const Vec3<S> u{v[x], flips ? -v[y] : v[y], flips ? -v[z] : v[z]};
    return {R.c * u.x + R.s * u.y, R.c * u.y - R.s * u.x, u.z};
  }

 private:
  /// Rz {xx, xy, 0; xy, yy, 0; 0, 0, 0} Rz^T.
  Sym3<S> turnedAboutZ(const S& xx, const S& xy, const S& yy) const {
    const S u = c * xx - s * xy, v = c * xy - s * yy, zero(0);
    return {c * u - s * v, s * u + c * v, zero, s * (s * xx + c * xy) + c * (s * xy + c * yy), zero, zero};
  }
};

/// R {xx, xy, 0; xy, yy, 0; 0, 0, 0} R^T.
template <class S>
Sym3<S> planarCongruence(const Mat3<S>& R, const S& xx, const S& xy, const S& yy) {
  const Vec3<S> x = R.col(0), y = R.col(1), u = xx * x + xy * y, v = xy * x + yy * y;
  return {u.x * x.x + v.x * y.x, u.x * x.y + v.x * y.y, u.x * x.z + v.x * y.z, u.y * x.y + v.y * y.y, u.y * x.z + v.y * y.z, u.z * x.z + v.z * y.z};
}
/// R {by_x, by_y, 0} R^T, of columns.
template <class S>
Mat3<S> planarCongruence(const Mat3<S>& R, const Vec3<S>& by_x, const Vec3<S>& by_y) {
  const Vec3<S> x = R.col(0), y = R.col(1), Rx = R * by_x, Ry = R * by_y;
  Mat3<S> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = Rx[i] * x[j] + Ry[i] * y[j];
  return out;
}

/// The first and the last column of A R, which is not formed.
template <class S>
Vec3<S> firstColumn(const Mat3<S>& A, const Mat3<S>& R) {
  return A * R.col(0);
}
template <class S>
Vec3<S> lastColumn(const Mat3<S>& A, const Mat3<S>& R) {
  return A * R.col(2);
}

/// The rotation from body i's axes to its parent's. If the placement does not rotate, as at a floating base, this is the joint's own rotation.
template <class S, class Joint, class Order>
Mat3<S> rotationOf(const Joint& joint, const Order& order, int i) {
  if constexpr (Order::shared_constants && requires { joint.rotation(); })
    if (order.index(i).exchange.changesNothing()) return joint.rotation();
  return joint.rotate(order.constants(i).placement.R);
}

/// Calls use(R) with the rotation from body i's axes to its parent's. R is an ExchangedTurn where possible, and whole() otherwise.
template <class Joint, class Order, class Whole, class Use>
void withRotation([[maybe_unused]] const Joint& joint, [[maybe_unused]] const Order& order, [[maybe_unused]] int i, Whole&& whole, Use&& use) {
  if constexpr (Joint::about_z && Order::shared_constants) {
    using S = std::remove_cvref_t<decltype(joint.c)>;
    const AxisExchange& exchange = order.index(i).exchange;
    const auto turn = [&]<int axis>() {
      if (exchange.flips) return use(ExchangedTurn<S, axis, true>(joint.c, joint.s));
      return use(ExchangedTurn<S, axis, false>(joint.c, joint.s));
    };
    if (exchange.shift == 0) return turn.template operator()<0>();
    if (exchange.shift == 1) return turn.template operator()<1>();
    if (exchange.shift == 2) return turn.template operator()<2>();
  }
  use(whole());
}
/// The same in an outward sweep. It stores a rotation from whole() in w.rel, where the inward sweep reads it.
template <class S, class Joint, class Order, class Use>
void withRotationOutward(const Joint& joint, const Order& order, int i, Use&& use) {
  const auto whole = [&] {
    Mat3<S> R = rotationOf<S>(joint, order, i);
    order.w.rel[i].R = R;
    return R;
  };
  withRotation(joint, order, i, whole, use);
}
template <class S, class Joint, class Order, class Use>
void withRotationInward(const Joint& joint, const Order& order, int i, Use&& use) {
  withRotation(
      joint, order, i, [&] { return order.w.rel[i].R; }, use);
}

/// Body i's origin in its parent's frame. If the joint moves the origin, the outward sweep stores it in w.rel, where the inward sweep reads it.
template <class S, class Joint, class Order>
Vec3<S> originInward(const Order& order, int i) {
  if constexpr (Joint::moves_origin) {
    return order.w.rel[i].p;
  } else {
    return order.constants(i).placement.p;
  }
}
template <class S, class Joint, class Order>
Vec3<S> originOutward(const Joint& joint, const Order& order, int i) {
  const auto& placement = order.constants(i).placement;
  if constexpr (Joint::moves_origin) order.w.rel[i].p = placement.p + placement.R * joint.translation();
  return originInward<S, Joint>(order, i);
}

/// A body's angular velocity in its own axes. `parent` is the parent's angular velocity in the same axes.
template <class Joint, class S>
Vec3<S> turnedInOwnAxes(const Vec3<S>& parent, const Motion<S>& joint) {
  if constexpr (Joint::about_z) {
    Vec3<S> sum = parent;
    addAt(sum, 2, joint.angular[2]);
    return sum;
  } else {
    return turnedBy<Joint>(parent, joint);
  }
}

}  // namespace dyn::kernels
