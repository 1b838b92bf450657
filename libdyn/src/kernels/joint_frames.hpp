// What recursions in joints' own frames share. A joint about an axis of its parent's has a rotation of which four numbers are c, s, -s and c, and one
// is 1 or -1: next to nothing is multiplied there.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// AxisExchange{shift, flips} times Rz(c, s), from a joint's axes to its parent's.
template <class S, int shift, bool flips>
struct ExchangedTurn {
  static constexpr int x = shift, y = (shift + 1) % 3, z = (shift + 2) % 3;  ///< the parent's axes that x, y and z are before the joint moves
  S c, s;

  /// Rz v.
  Vec3<S> turned(const Vec3<S>& v) const { return {c * v.x - s * v.y, s * v.x + c * v.y, v.z}; }
  /// Rz a Rz^T.
  Sym3<S> turned(const Sym3<S>& a) const {
    const S u = c * a.xx - s * a.xy, v = c * a.xy - s * a.yy;
    return {c * u - s * v, s * u + c * v, c * a.xz - s * a.yz, s * (s * a.xx + c * a.xy) + c * (s * a.xy + c * a.yy), s * a.xz + c * a.yz, a.zz};
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

  friend Vec3<S> operator*(const ExchangedTurn& R, const Vec3<S>& v) { return exchanged(R.turned(v)); }
  friend Vec3<S> transposeTimes(const ExchangedTurn& R, const Vec3<S>& v) {
    const S &a = v[x], b = flips ? -v[y] : v[y];
    return {R.c * a + R.s * b, R.c * b - R.s * a, flips ? -v[z] : v[z]};
  }
};

/// Of A R, which is not made.
template <class S>
Vec3<S> firstColumn(const Mat3<S>& A, const Mat3<S>& R) {
  return A * R.col(0);
}
template <class S>
Vec3<S> lastColumn(const Mat3<S>& A, const Mat3<S>& R) {
  return A * R.col(2);
}

/// Calls use(R), R the rotation of body i's axes to its parent's; whole() where it may be any.
template <class Joint, class Order, class Whole, class Use>
void withRotation([[maybe_unused]] const Joint& joint, [[maybe_unused]] const Order& order, [[maybe_unused]] int i, Whole&& whole, Use&& use) {
  if constexpr (Joint::about_z && Order::alike) {
    const auto [shift, flips] = order.index(i).exchange;
    const auto turn = [&]<int axis>() {
      using S = std::remove_cvref_t<decltype(joint.c)>;
      return flips ? use(ExchangedTurn<S, axis, true>{joint.c, joint.s}) : use(ExchangedTurn<S, axis, false>{joint.c, joint.s});
    };
    if (shift == 0) return turn.template operator()<0>();
    if (shift == 1) return turn.template operator()<1>();
    if (shift == 2) return turn.template operator()<2>();
  }
  use(whole());
}
/// The same in a sweep outward, which leaves what the inward one needs in w.rel.
template <class S, class Joint, class Order, class Use>
void withRotationOutward(const Joint& joint, const Order& order, int i, Use&& use) {
  const auto whole = [&] {
    Mat3<S> R = joint.rotate(order.constants(i).placement.R);
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

/// Body i's origin in its parent's frame; where the joint moves it, an outward sweep leaves it to the inward one in the same way.
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

/// A body's angular velocity, `parent` being its parent's, in its own axes.
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
