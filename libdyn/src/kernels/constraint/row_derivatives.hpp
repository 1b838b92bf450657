// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of constraints between frames, from the variations that derivativesOutward (rnea_derivatives.hpp) writes.
//
// Moving along a degree of freedom on the root path of a constraint's point P turns the body of P by theta. It changes the velocities of P and of the
// body by theta x v + v~, and their accelerations by theta x a + a~. Here v~ and a~ are velocity and acceleration of rnea_derivatives.hpp (2) and
// (3), which hold for the whole subtree, moved to P. All vectors are in the aligned axes of the first body's tree. P is on body 1; V is its velocity
// and W the angular velocity of body 1, both as seen from body 2; a2 is the acceleration of the point of body 2 at P; Omega is the angular velocity
// of the constraint's axes, or zero where their rotation has no effect. In these axes the rows' acceleration is
//   [a1 - a2 - w2 x V - Omega x V;  alpha1 - alpha2 - Omega x W]
// This file writes its variation, without the part that the rotation of the axes themselves causes.
#pragma once

#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/derivative/recursion.hpp"
#include "kernels/pack/columns.hpp"

namespace dyn::kernels {

/// The effect of a degree of freedom on a point and on the point's body.
template <class S>
struct PointColumn {
  Motion<S> displacement;  ///< by q; also the change of the velocity by v, and of the acceleration by a
  Motion<S> velocity;      ///< v~
  Motion<S> acceleration;  ///< a~
  Motion<S> rate;          ///< change of the acceleration by v
};
using StoredColumn = PointColumn<Vectored>;
inline const Vec3<Vectored>& vectored(const Vec3<Vectored>& v) { return v; }
inline Vec3<Vectored> vectored(const Vec3<InOneLane>& v) { return {v.first[0], v.first[group_lanes], v.first[2 * group_lanes]}; }

/// The velocities of a point and of its body; the acceleration of the point, less gravity, and of its body.
struct PointMotion {
  Motion<double> velocity, acceleration;
};

inline const Motion<Vectored>& vectored(const Motion<Vectored>& m) { return m; }
inline Motion<Vectored> vectored(const Motion<InOneLane>& m) { return {vectored(m.linear), vectored(m.angular)}; }

template <class Left>
PointMotion pointColumnsOf(const CompactImpl& m, const Left& left, int body, const Vec3<double>& arm, const int* path, StoredColumn* out) {
  using S = Vectored;
  const Vec3<S> omega = vectored(left.turning(body)), start = Vec3<S>(arm.x, arm.y, arm.z), start_rate = cross(omega, start);
  const auto parentOf = [&](int i) { return m.index[static_cast<std::size_t>(i)].parent; };
  Vec3<S> velocity = start_rate;
  for (int i = body; i > 0; i = parentOf(i)) velocity += vectored(left.offsetRate(i));
  // r: from the joint's origin to the point; rate: its rate of change.
  Vec3<S> r = start, rate = start_rate;
  for (int i = body; i > 0; i = parentOf(i)) {
    const BodyIndex& index = m.index[static_cast<std::size_t>(i)];
    for (int k = index.idx_v; k < index.idx_v + index.nv; ++k) {
      const auto& change = left.variation(k);
      const Motion<S>&s = vectored(left.column(k)), &by_v = vectored(change.rate);
      const Motion<S>&dv = vectored(change.velocity), &da = vectored(change.acceleration);
      const Vec3<S>&turn = s.angular, &more = dv.angular;
      const auto atPoint = [&](const Motion<S>& a) { return a.linear + cross(a.angular, r); };
      out[*path++] = {{atPoint(s), turn},
                      {atPoint(dv) - cross(turn, velocity - rate), more},
                      {atPoint(da) + S(2) * cross(more, rate), da.angular + cross(more, omega)},
                      {atPoint(by_v) + S(2) * cross(turn, rate), by_v.angular + cross(turn, omega)}};
    }
    r += vectored(left.offset(i));
    rate += vectored(left.offsetRate(i));
  }
  const Motion<S>& a = vectored(left.acceleration(body));
  const Vec3<S> acceleration = a.linear + cross(a.angular, start) + cross(omega, start_rate);
  return {{cast<double>(velocity), cast<double>(omega)}, {cast<double>(acceleration), cast<double>(a.angular)}};
}

/// Returns the motion of the point at `arm` from body's origin, after derivativesOutward. Writes its columns to out[path[k]], where k counts the
/// degrees of freedom from the body to the world, within a joint the first one first.
inline PointMotion pointColumns(const CompactImpl& m, const DerivativeWorkspace<double>& d, int body, const Vec3<double>& arm, const int* path,
                                StoredColumn* out) {
  if (d.lane_groups) return pointColumnsOf(m, LeftByLaneGroups{m.lane_groups, d.group_arrays}, body, arm, path, out);
  return pointColumnsOf(m, LeftByBodies<Vectored>{d.bodies, *d.vectored}, body, arm, path, out);
}

/// Matrices of all constraints with a column for each of the user's degrees of freedom: of `rows` numbers, or of nv in force_by_q.
struct RowDerivatives {
  double *by_q, *by_v, *J;  ///< derivatives of the rows' accelerations, feedback included
  double* force_by_q;       ///< the effect of turning and moving the rows' forces is added, with the sign of M a + h - J^T lambda
  std::ptrdiff_t rows, nv;
};

/// The state of one constraint, and the feedback of its error.
struct RowState {
  const FrameRows& frame;
  PointMotion points[2];          ///< both in the axes of the first body's tree
  Baumgarte gains;                ///< of the feedback
  Mat3<double> error_by_turning;  ///< derivative of the error's angular part by the rotation of the first body against the second
  Force<double> force;            ///< sum of the rows' forces, at the point
};

template <class Wide>
Motion<Wide> crossBoth(const Vec3<Wide>& w, const Motion<Wide>& x) {
  return {cross(w, x.linear), cross(w, x.angular)};
}

/// Neighbouring columns, one in each lane; lanes past the end repeat the last column.
template <class Wide>
PointColumn<Wide> columnsTogether(const StoredColumn* columns, int first, int count) {
  constexpr int numbers = sizeof(StoredColumn) / sizeof(double), lanes = lanes_of<Wide>;
  const double* from[lanes];
  for (int l = 0; l < lanes; ++l) from[l] = reinterpret_cast<const double*>(columns + std::min(first + l, count - 1));
  Wide x[numbers];
  gatherStructs<numbers>(from, x);
  const auto motion = [&](int i) { return Motion<Wide>{{x[8 * i], x[8 * i + 1], x[8 * i + 2]}, {x[8 * i + 4], x[8 * i + 5], x[8 * i + 6]}}; };
  return {motion(0), motion(1), motion(2), motion(3)};
}

/// The variation of one constraint's rows along degrees of freedom, one in each lane. Vectors that are the same for all lanes are stored as packs.
template <class Wide>
class RowVariation {
 public:
  RowVariation(const PackedFrameConstraint& c, const RowState& x) : c_(c), gains_(x.gains) {
    const Motion<double>&v1 = x.points[0].velocity, &v2 = x.points[1].velocity, V = v1 - v2;
    const Vec3<double> omega = pick(turning(), v1.angular, v2.angular, Vec3<double>{});
    Motion<double> rate = x.points[0].acceleration - x.points[1].acceleration - crossBoth(omega, V);
    rate.linear -= cross(v2.angular, V.linear);
    for (int e = 0; e < 2; ++e) {
      velocity_[e] = wide(x.points[e].velocity);
      acceleration_[e] = wide(x.points[e].acceleration);
    }
    V_ = wide(V);
    rate_ = wide(rate);
    omega_ = cast<Wide>(omega);
    error_ = wide(x.frame.error);
    turn_ = cast<Wide>(x.frame.turn);
    error_by_turning_ = cast<Wide>(x.error_by_turning);
  }

  struct Result {
    Motion<Wide> by_q, by_v, by_a;
    Motion<Wide> first, second;  ///< displacements of the bodies' points
    Vec3<Wide> axes;             ///< rotation of the constraint's axes
  };
  /// `second_own` is in its own tree's axes; it is zero if the second body is the world.
  template <bool second_moves>
  Result of(const PointColumn<Wide>& first, const PointColumn<Wide>& second_own) const {
    const Vec3<Wide>& w2 = velocity_[1].angular;
    PointColumn<Wide> second{};
    if constexpr (second_moves)
      second = {turnedBack(turn_, second_own.displacement), turnedBack(turn_, second_own.velocity), turnedBack(turn_, second_own.acceleration),
                turnedBack(turn_, second_own.rate)};
    const Vec3<Wide>&turn1 = first.displacement.angular, &turn2 = second.displacement.angular, still{};
    const Motion<Wide> moved = first.displacement - second.displacement, v1 = crossBoth(turn1, velocity_[0]) + first.velocity;
    Motion<Wide> v = v1, a = crossBoth(turn1, acceleration_[0]) + first.acceleration, a_by_v = first.rate;
    Vec3<Wide> w2_by_q{};
    if constexpr (second_moves) {
      const Motion<Wide> v2 = crossBoth(turn2, velocity_[1]) + second.velocity;
      w2_by_q = v2.angular;
      v -= v2;
      v.linear -= cross(w2, moved.linear);
      a -= crossBoth(turn2, acceleration_[1]) + second.acceleration;
      a.linear -=
          cross(acceleration_[1].angular, moved.linear) + cross(w2, cross(w2, moved.linear)) + cross(w2_by_q, V_.linear) + cross(w2, v.linear);
      a_by_v -= second.rate;
      a_by_v.linear -= cross(turn2, V_.linear) + cross(w2, moved.linear);
    }
    if (turning() != Follows::none) {
      a -= crossBoth(pick(turning(), v1.angular, w2_by_q, still), V_) + crossBoth(omega_, v);
      a_by_v -= crossBoth(pick(turning(), turn1, turn2, still), V_) + crossBoth(omega_, moved);
    }
    const Vec3<Wide> axes = pick(axesFollow(), turn1, turn2, still);
    a -= crossBoth(axes, rate_);
    if (gains_.velocity > 0) {
      a += Wide(gains_.velocity) * (v - crossBoth(axes, V_));
      a_by_v += Wide(gains_.velocity) * moved;
    }
    if (gains_.position > 0) {
      // The change of the error as seen in axes that turn with the first frame, plus the rotation of these axes against the constraint's.
      const Motion<Wide> error{moved.linear + cross(turn2, error_.linear) - cross(turn1, error_.linear), error_by_turning_ * moved.angular};
      a += Wide(gains_.position) * (error + crossBoth(turn1 - axes, error_));
    }
    return {a, a_by_v, moved, first.displacement, second.displacement, axes};
  }

 private:
  enum class Follows { none, first, second };
  Follows axesFollow() const {
    if (c_.axes == ConstraintAxes::LOCAL) return Follows::first;
    return c_.axes == ConstraintAxes::OTHER ? Follows::second : Follows::none;
  }
  /// The body with whose rotation the axes turn, if that matters. It does not for a point that is held in all directions of its own body's axes.
  Follows turning() const { return axesFollow() == Follows::first && c_.turnsFreely() && c_.rows == 3 ? Follows::none : axesFollow(); }
  template <class V>
  static const V& pick(Follows which, const V& first, const V& second, const V& none) {
    return which == Follows::first ? first : (which == Follows::second ? second : none);
  }
  static Motion<Wide> wide(const Motion<double>& x) { return {cast<Wide>(x.linear), cast<Wide>(x.angular)}; }

  const PackedFrameConstraint& c_;
  const Baumgarte gains_;
  Motion<Wide> velocity_[2], acceleration_[2], V_, rate_, error_;
  Vec3<Wide> omega_;
  Mat3<Wide> turn_, error_by_turning_;
};

/// The columns of both points from slot `first` on, each in the axes of its own tree.
template <class Wide>
std::pair<PointColumn<Wide>, PointColumn<Wide>> bothPackable(const PackedFrameConstraint& c, const StoredColumn* const* columns, int first) {
  const auto count = static_cast<int>(c.slots.size());
  const auto read = [&](int e) { return c.body[e] > 0 ? columnsTogether<Wide>(columns[e], first, count) : PointColumn<Wide>{}; };
  return {read(0), read(1)};
}

/// Adds to force_by_q the projections, on the displacements along each slot, of the changes of the rows' forces along every other slot: turning[0 to
/// 5] on the first body, turning[6 to 11] on the second.
template <class Wide>
void addForceTurning(const PackedFrameConstraint& c, const Mat3<double>& turn, const StoredColumn* const* columns, const Rows<double>& turning,
                     const RowDerivatives& out) {
  constexpr int lanes = lanes_of<Wide>;
  const auto count = static_cast<int>(c.slots.size());
  const auto userOf = [&](int slot) { return c.slots[static_cast<std::size_t>(slot)].user; };
  for (int first = 0; first < count; first += lanes) {
    const auto [own, other] = bothPackable<Wide>(c, columns, first);
    const Motion<Wide> s[2] = {own.displacement, turnedBack(cast<Wide>(turn), other.displacement)};
    for (int k = 0; k < count; ++k) {
      if (userOf(k) < 0) continue;
      Wide sum(0);
      for (int a = 0; a < 3; ++a) {
        sum += s[1].linear[a] * Wide(turning[6 + a][k]) + s[1].angular[a] * Wide(turning[9 + a][k]);
        sum -= s[0].linear[a] * Wide(turning[a][k]) + s[0].angular[a] * Wide(turning[3 + a][k]);
      }
      alignas(64) double sums[lanes];
      storePack(sum, sums);
      for (int l = 0; l < std::min(lanes, count - first); ++l)
        if (userOf(first + l) >= 0) out.force_by_q[out.nv * userOf(k) + userOf(first + l)] += sums[l];
    }
  }
}

/// Writes the derivatives of one constraint to `out`. columns[e]: the columns of body e's point, one for each slot of c.slots, zero where the slot
/// does not move it. `turning`: scratch, 12 rows of one number a slot.
template <class Wide>
void rowDerivatives(const PackedFrameConstraint& c, const RowState& x, const StoredColumn* const* columns, const Rows<double>& turning,
                    const RowDerivatives& out) {
  constexpr int lanes = lanes_of<Wide>;
  const auto count = static_cast<int>(c.slots.size());
  const RowVariation<Wide> variation(c, x);
  const Mat3<Wide> axes = cast<Wide>(x.frame.base * c.own_axes);
  const Force<Wide> force{cast<Wide>(x.force.linear), cast<Wide>(x.force.angular)};
  alignas(64) double numbers[3][6][lanes];
  for (int first = 0; first < count; first += lanes) {
    const auto [own, other] = bothPackable<Wide>(c, columns, first);
    const auto along = c.body[1] > 0 ? variation.template of<true>(own, other) : variation.template of<false>(own, other);
    int at = 0;
    for (const Motion<Wide>* motion : {&along.by_q, &along.by_v, &along.by_a}) {
      const Motion<Wide> by_axes = turnedBack(axes, *motion);
      for (int k = 0; k < 3; ++k) {
        storePack(by_axes.linear[k], numbers[at][k]);
        storePack(by_axes.angular[k], numbers[at][3 + k]);
      }
      ++at;
    }
    for (int l = 0; l < std::min(lanes, count - first); ++l) {
      const int user = c.slots[static_cast<std::size_t>(first + l)].user;
      if (user < 0) continue;
      eachDirection(c, [&](int row, int direction) {
        const std::ptrdiff_t entry = out.rows * user + row;
        out.by_q[entry] = numbers[0][direction][l];
        out.by_v[entry] = numbers[1][direction][l];
        out.J[entry] = numbers[2][direction][l];
      });
    }
    if (!c.forceTurns()) continue;
    // The force turns with its axes, whereas the derivatives of inverse dynamics turned it with each body. On the second body its point moves, too.
    const auto turned = [&](const Vec3<Wide>& w) { return Force<Wide>{cross(w, force.linear), cross(w, force.angular)}; };
    const Force<Wide> on_first = turned(along.axes - along.first.angular);
    Force<Wide> on_second = turned(along.axes - along.second.angular);
    on_second.angular += cross(along.by_a.linear, force.linear);
    for (int k = 0; k < 3; ++k) {
      storePack(on_first.linear[k], turning[k] + first);
      storePack(on_first.angular[k], turning[3 + k] + first);
      storePack(on_second.linear[k], turning[6 + k] + first);
      storePack(on_second.angular[k], turning[9 + k] + first);
    }
  }
  if (c.forceTurns()) addForceTurning<Wide>(c, x.frame.turn, columns, turning, out);
}

}  // namespace dyn::kernels
