// Derivatives of constraints between frames, from the variations that the pass outward of inverse dynamics' derivatives leaves.
//
// Moving along a degree of freedom below a constraint's point P turns what P is fixed to with theta, and changes P's velocity, and its body's,
// by theta x v + v~, its acceleration by theta x a + a~ (rnea_derivatives.hpp, where v~ and a~ are those of the whole subtree; here they are
// brought to P). All vectors in the aligned axes of the first body's tree. With P on body 1, V its velocity and W the rotation of body 1 as body 2
// sees them, Omega the rotation of the constraint's axes as far as it counts, the rows' acceleration is in these axes
//   [a1 - a2 - w2 x V - Omega x V;  alpha1 - alpha2 - Omega x W]
// where a2 is that of the point of body 2 that is at P. Its variation, less the axes' own turning, is what this file writes.
#pragma once

#include "kernels/columns.hpp"
#include "kernels/constraint_workspace.hpp"
#include "kernels/recursion.hpp"

namespace dyn::kernels {

/// What a degree of freedom does to a point and to the body that it is fixed to.
template <class S>
struct PointColumn {
  Motion<S> displacement;  ///< by q; also that of the velocity by v, and of the acceleration by a
  Motion<S> velocity;      ///< v~
  Motion<S> acceleration;  ///< a~
  Motion<S> rate;          ///< of the acceleration by v
};
using StoredColumn = PointColumn<Vectored>;
inline const Vec3<Vectored>& vectored(const Vec3<Vectored>& v) { return v; }
inline Vec3<Vectored> vectored(const Vec3<Seated>& v) { return {v.first[0], v.first[strip_lanes], v.first[2 * strip_lanes]}; }

/// Velocity of a point and its body; the point's acceleration, gravity's taken off, and the body's.
struct PointMotion {
  Motion<double> velocity, acceleration;
};

inline const Motion<Vectored>& vectored(const Motion<Vectored>& m) { return m; }
inline Motion<Vectored> vectored(const Motion<Seated>& m) { return {vectored(m.linear), vectored(m.angular)}; }

template <class Left>
PointMotion pointColumnsOf(const CompactImpl& m, const Left& left, int body, const Vec3<double>& lever, const int* path, StoredColumn* out) {
  using S = Vectored;
  const Vec3<S> omega = vectored(left.turning(body)), start = Vec3<S>(lever.x, lever.y, lever.z), start_rate = cross(omega, start);
  const auto parentOf = [&](int i) { return m.index[static_cast<std::size_t>(i)].parent; };
  Vec3<S> velocity = start_rate;
  for (int i = body; i > 0; i = parentOf(i)) velocity += vectored(left.leverRate(i));
  // Of the point, from the joint's origin, and how that changes.
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
    r += vectored(left.lever(i));
    rate += vectored(left.leverRate(i));
  }
  const Motion<S>& a = vectored(left.acceleration(body));
  const Vec3<S> acceleration = a.linear + cross(a.angular, start) + cross(omega, start_rate);
  return {{cast<double>(velocity), cast<double>(omega)}, {cast<double>(acceleration), cast<double>(a.angular)}};
}

/// Of the point at `lever` from body's origin, after derivativesOutward: its motion, and its columns to out[path[k]] in the order in which
/// degrees of freedom are met on the way from the body to the world, joint by joint the first one first.
inline PointMotion pointColumns(const CompactImpl& m, const DerivativeWorkspace<double>& d, int body, const Vec3<double>& lever, const int* path,
                                StoredColumn* out) {
  if (d.strips) return pointColumnsOf(m, LeftByStrips{m.strips, d.strip_arrays}, body, lever, path, out);
  return pointColumnsOf(m, LeftByBodies<Vectored>{d.bodies, *d.vectored}, body, lever, path, out);
}

/// A constraint's part of matrices with a column a degree of freedom of the user's: `rows` numbers each, or nv.
struct RowDerivatives {
  double *by_q, *by_v, *J;  ///< of the rows' accelerations, with their feedback
  double* force_by_q;       ///< to which is added what turning and moving the rows' forces changes, with the sign of M a + h - J^T lambda
  std::ptrdiff_t rows, nv;
};

/// One constraint at its state, and what is fed back of its error.
struct RowState {
  const FrameRows& frame;
  PointMotion points[2];          ///< the second in the first's axes
  Baumgarte gains;                ///< of what is fed back
  Mat3<double> error_by_turning;  ///< of the error's angular part, by how the first body turns against the second
  Force<double> force;            ///< of the rows, at the point
};

template <class Wide>
Motion<Wide> crossBoth(const Vec3<Wide>& w, const Motion<Wide>& x) {
  return {cross(w, x.linear), cross(w, x.angular)};
}

/// Neighbours' columns in lanes; those past the end repeat the last.
template <class Wide>
PointColumn<Wide> columnsAbreast(const StoredColumn* columns, int first, int count) {
  constexpr int numbers = sizeof(StoredColumn) / sizeof(double), lanes = lanes_of<Wide>;
  const double* from[lanes];
  for (int l = 0; l < lanes; ++l) from[l] = reinterpret_cast<const double*>(columns + std::min(first + l, count - 1));
  Wide x[numbers];
  gatherStructs<numbers>(from, x);
  const auto motion = [&](int i) { return Motion<Wide>{{x[8 * i], x[8 * i + 1], x[8 * i + 2]}, {x[8 * i + 4], x[8 * i + 5], x[8 * i + 6]}}; };
  return {motion(0), motion(1), motion(2), motion(3)};
}

/// What one constraint's rows do along one degree of freedom, by lanes; vectors that are the same for all as they are multiplied with.
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
    Vec3<Wide> axes;             ///< how the constraint's axes turn
  };
  /// `second` in its own tree's axes; without bodies on it zero.
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
      // As axes that turn with the first frame see it, which then turn against the constraint's.
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
  /// A point that cannot move at all is held by its own acceleration, whatever its axes do.
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

/// Columns of the points, from slot `first` on, each in the axes of its own tree.
template <class Wide>
std::pair<PointColumn<Wide>, PointColumn<Wide>> bothAbreast(const PackedFrameConstraint& c, const StoredColumn* const* columns, int first) {
  const auto count = static_cast<int>(c.slots.size());
  const auto read = [&](int e) { return c.body[e] > 0 ? columnsAbreast<Wide>(columns[e], first, count) : PointColumn<Wide>{}; };
  return {read(0), read(1)};
}

/// The rows' forces f, turned and moved along a slot, on the displacements along another: turning[0 to 5] on the first body, turning[6 to 11] on the
/// second.
template <class Wide>
void addForceTurning(const PackedFrameConstraint& c, const Mat3<double>& turn, const StoredColumn* const* columns, const Rows<double>& turning,
                     const RowDerivatives& out) {
  constexpr int lanes = lanes_of<Wide>;
  const auto count = static_cast<int>(c.slots.size());
  const auto userOf = [&](int slot) { return c.slots[static_cast<std::size_t>(slot)].user; };
  for (int first = 0; first < count; first += lanes) {
    const auto [own, other] = bothAbreast<Wide>(c, columns, first);
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

/// columns[e]: of body e's point, one a slot of c.slots, zero where the slot does not move it; `turning`: 12 rows for a number a slot, scratch.
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
    const auto [own, other] = bothAbreast<Wide>(c, columns, first);
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
    // The force turns with its axes, where the derivative of inverse dynamics had it turn with each body, and its point moves on the second.
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
