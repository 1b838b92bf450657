// The articulated-body algorithm in joints' own frames (Featherstone 2008, ch. 7), with classical accelerations, for packs of states.
//
// As accurate as in aligned frames, and fewer operations where nothing waits for the next rotation: inertias come as constants, a joint about z has
// entries of its inertia for a pivot, what is left of that has nothing about z, and where placements exchange axes only sines and cosines are
// multiplied. Strips need one placement for each lane, single states have rotations that wait for one another: they go the aligned way (aba.hpp).
#pragma once

#include "kernels/aba.hpp"
#include "kernels/joint_frames.hpp"

namespace dyn::kernels {

template <class S, class Order>
void localAbaOutward(const Order& order, Workspace<S>& w, const S* v) {
  w.w[0] = {};
  order.forward(passing(w.w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning) {
    const Motion<S> s = joint.times(v + iv);
    const bool carries = !order.isRoot(i);
    Vec3<S> carried{};
    Motion<S> beta{};
    if (carries) {
      carried = turning.get();
      alongLever<S, Joint>(
          order, i, [&] { return originOutward<S>(joint, order, i); }, [&](const auto& r) { addCentripetal(beta.linear, carried, r); });
    }
    withRotationOutward<S>(joint, order, i, [&](const auto& R) {
      if (!carries) return;
      carried = transposeTimes(R, carried);
      beta.linear = transposeTimes(R, beta.linear);
    });
    const Vec3<S> omega = turnedInOwnAxes<Joint>(carried, s);
    if constexpr (Joint::about_z) {
      beta.angular = crossZ(carried, s.angular[2]);
    } else if constexpr (Joint::has_angular) {
      beta.angular = cross(carried, s.angular);
    }
    if constexpr (Joint::has_linear) beta.linear += cross(carried + omega, s.linear);
    if constexpr (Joint::has_bias) beta += joint.bias();
    w.beta[i] = beta;
    turning.leave(omega);
  });
}

/// What is left of a body's inertia where it may turn about z as it likes: no torque about z, and nothing that turning about z would take.
template <class S>
struct HingedInertia {
  Sym3<S> linear;
  Vec3<S> by_x, by_y;  ///< force by accelerations about x and y
  S xx, xy, yy;        ///< torque about x and y by the same

  /// W: column of I for turning about z; inverse: of its last entry.
  HingedInertia(const ArticulatedInertia<S>& I, const Force<S>& W, const S& inverse) {
    const Vec3<S>& a = W.linear;
    const Vec3<S> scaled = inverse * a;
    const S x = inverse * W.angular.x, y = inverse * W.angular.y;
    linear = I.linear - Sym3<S>{a.x * scaled.x, a.x * scaled.y, a.x * scaled.z, a.y * scaled.y, a.y * scaled.z, a.z * scaled.z};
    by_x = I.coupling.col(0) - x * a;
    by_y = I.coupling.col(1) - y * a;
    xx = I.angular.xx - W.angular.x * x;
    xy = I.angular.xy - W.angular.x * y;
    yy = I.angular.yy - W.angular.y * y;
  }

  Force<S> operator*(const Motion<S>& a) const {
    return {linear * a.linear + a.angular.x * by_x + a.angular.y * by_y,
            {dot(by_x, a.linear) + xx * a.angular.x + xy * a.angular.y, dot(by_y, a.linear) + xy * a.angular.x + yy * a.angular.y, S(0)}};
  }

  /// In axes that R leads to.
  ArticulatedInertia<S> in(const Mat3<S>& R) const {
    const Vec3<S> x = R.col(0), y = R.col(1), Rx = R * by_x, Ry = R * by_y, u = xx * x + xy * y, v = xy * x + yy * y;
    ArticulatedInertia<S> out;
    out.linear = congruence(R, linear);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) out.coupling(i, j) = Rx[i] * x[j] + Ry[i] * y[j];
    out.angular = {u.x * x.x + v.x * y.x, u.x * x.y + v.x * y.y, u.x * x.z + v.x * y.z,
                   u.y * x.y + v.y * y.y, u.y * x.z + v.y * y.z, u.z * x.z + v.z * y.z};
    return out;
  }
  template <int shift, bool flips, bool tilts>
  ArticulatedInertia<S> in(const ExchangedTurn<S, shift, flips, tilts>& R) const {
    const Vec3<S> x = R.turned(R.c * by_x - R.s * by_y), y = R.turned(R.s * by_x + R.c * by_y);
    return {R.exchanged(R.turned(linear)), R.exchanged(R.tiltedColumns(x, y)), R.exchanged(R.turnedPlanar(xx, xy, yy))};
  }
};

/// One column of a joint's subspace in its own axes, to use(column).
template <class S, class Joint, class Use>
void withOwnColumn([[maybe_unused]] const Joint& joint, int k, Use&& use) {
  if constexpr (requires { Joint::direction(k); }) {
    use(UnitColumn<S>{Joint::direction(k)});
  } else {
    const Motion<S> column = joint.column(k);
    use(Column<Joint, S>{column});
  }
}

/// Eliminates the last direction of body i, whose bias force is f, from IA. What is left, in the parent's axes about the body's origin; f becomes the
/// force that goes with it.
template <class S, class Joint, class Order>
ArticulatedInertia<S> leftInParentsAxes(const Joint& joint, const Order& order, int i, const DofFactor<S>& last, ArticulatedInertia<S>& IA,
                                        Force<S>& f) {
  f += last.y * last.W;
  if constexpr (Joint::about_z) {
    // Armature does not fall with the body, and leaves something about z.
    if (order.m.armature.empty()) {
      const HingedInertia<S> left(IA, last.W, last.inverse);
      f += left * order.w.beta[i];
      ArticulatedInertia<S> out;
      withRotationInward<S>(joint, order, i, [&](const auto& R) {
        out = left.in(R);
        f = {R * f.linear, R * f.angular};
      });
      return out;
    }
  }
  IA.subtractSquare(last.W, last.inverse);
  f += IA * order.w.beta[i];
  const Mat3<S> R = joint.rotate(order.constants(i).placement.R);
  f = {R * f.linear, R * f.angular};
  return {congruence(R, IA.linear), R * IA.coupling * transpose(R), congruence(R, IA.angular)};
}

/// Leaves w.dof's W, inverse and y. w.failed as abaInward does.
template <class S, class Order>
void localAbaInward(const Order& order, Workspace<S>& w, const S* tau) {
  for (int& body : w.failed) body = 0;
  order.backward(passing(w.IA, w.pA), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& inertia, auto&& force) {
    const auto& c = order.constants(i);
    const Vec3<S>& omega = w.w[i];
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(c.mass, c.h, c.origin));
    Force<S> f = force.with({cross(omega, cross(omega, c.h)), cross(omega, c.origin * omega)});
    if (isBareRoot<Joint>(order, i)) {
      if constexpr (Joint::is_free) eliminateBareRoot(order, IA, f, tau + iv, i, iv, w);
      return;
    }
    for (int k = 0; k < Joint::nv; ++k)
      withOwnColumn<S>(joint, k, [&](const auto& column) {
        if (k > 0) {
          const DofFactor<S>& before = w.dof[iv + k - 1];
          IA.subtractSquare(before.W, before.inverse);
          f += before.y * before.W;
        }
        eliminate(order, IA, f, column, tau, iv + k, i, w);
      });
    if (order.isRoot(i)) return;

    ArticulatedInertia<S> left = leftInParentsAxes(joint, order, i, w.dof[iv + Joint::nv - 1], IA, f);
    alongLever<S, Joint>(
        order, i, [&] { return originInward<S, Joint>(order, i); }, [&](const auto& r) { shift(left, f, r); });
    inertia.give(left);
    force.give(f);
  });
}

/// Accelerations under this gravity, parents first; within a joint in the reverse order of elimination.
template <class S, class Order>
void localAbaSolve(const Order& order, Workspace<S>& w, const Vec3<S>& gravity, S* ddq) {
  w.acc[0] = {-gravity, {}};
  order.forward(passing(w.acc), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& acceleration) {
    Motion<S> a = acceleration.get();
    const bool turns = !order.isRoot(i);
    if (turns)
      alongLever<S, Joint>(
          order, i, [&] { return originInward<S, Joint>(order, i); }, [&](const auto& r) { addCross(a.linear, a.angular, r); });
    withRotationInward<S>(joint, order, i, [&](const auto& R) {
      a.linear = transposeTimes(R, a.linear);
      if (turns) a.angular = transposeTimes(R, a.angular);
    });
    a += w.beta[i];
    for (int k = Joint::nv - 1; k >= 0; --k)
      withOwnColumn<S>(joint, k, [&](const auto& column) {
        const DofFactor<S>& dof = w.dof[iv + k];
        ddq[iv + k] = dof.y - dof.inverse * dot(a, dof.W);
        column.addTo(a, ddq[iv + k]);
      });
    acceleration.leave(a);
  });
}

}  // namespace dyn::kernels
