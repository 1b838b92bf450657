#include "constraint/linearize.hpp"

#include "algorithm/motion_derivatives.hpp"
#include "joint/coordinate.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyn {

namespace {

using Vec = Vec3<double>;
using Twist = Motion<double>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

Twist read(const double* x) { return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}; }
/// Both parts turned.
Twist turned(const Vec& w, const Twist& x) { return {cross(w, x.linear), cross(w, x.angular)}; }

/// One constraint between frames in the axes of the first, at its origin, 1; the second's quantities moved there. r: the difference.
class RelativeMotion {
 public:
  RelativeMotion(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const PackedFrameConstraint& f, const FrameRows& rows) : c_(f) {
    for (int e = 0; e < 2; ++e) {
      moves_[e] = f.body[e] > 0;
      if (!moves_[e]) continue;
      motionDerivatives(m, d, {f.body[e], f.placement[e]}, ReferenceFrame::LOCAL, c.columns[e]);
      for (int k = 0; k < 5; ++k) columns_[e][k] = c.columns[e][k];
    }
    const SE3<double> poses[2] = {d.oM[f.body[0]] * f.placement[0], d.oM[f.body[1]] * f.placement[1]};
    X_ = poses[0].inverse() * poses[1];
    v1_ = f.placement[0].actInv(d.v[f.body[0]]);
    a1_ = f.placement[0].actInv(d.a[f.body[0]]);
    v2_ = X_.act(f.placement[1].actInv(d.v[f.body[1]]));
    a2_ = X_.act(f.placement[1].actInv(d.a[f.body[1]]));
    v_ = v1_ - v2_;
    a_ = a1_ - a2_ + v1_.cross(v2_);
    switch (f.axes) {
      case ConstraintAxes::LOCAL:
        axes_ = Mat3<double>::identity();
        break;
      case ConstraintAxes::OTHER:
        axes_ = X_.R;
        break;
      case ConstraintAxes::LOCAL_WORLD_ALIGNED:
        axes_ = transpose(poses[0].R);
    }
    // In axes that turn with w, what has the derivative a in those of 1 has a + (w1 - w) x v.
    point_ = f.turnsFreely() && f.rows == 3 && f.axes == ConstraintAxes::LOCAL;
    lag_ = f.axes == ConstraintAxes::OTHER ? v_.angular : (f.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED || point_ ? v1_.angular : Vec{});
    rate_ = a_ + turned(lag_, v_);
    error_ = {axes_ * rows.error.linear, axes_ * rows.error.angular};
  }

  /// Columns of degree of freedom k.
  struct Column {
    Twist s1, s2, s;  ///< motions of the frames and their difference
    Vec lag;          ///< how frame 1 turns against the axes
    Twist v_dq, a_dq, a_dv;
  };
  Column column(int k) const {
    const auto of = [&](int e, int which) { return moves_[e] ? read(columns_[e][which] + 6 * k) : Twist{}; };
    Column x;
    x.s1 = of(0, 1);
    x.s2 = X_.act(of(1, 1));
    x.s = x.s1 - x.s2;
    x.lag = c_.axes == ConstraintAxes::OTHER ? x.s.angular : (c_.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED ? x.s1.angular : Vec{});
    const Twist v1 = of(0, 0), v2 = X_.act(of(1, 0)) - x.s.cross(v2_);
    const Twist a1 = of(0, 2), a2 = X_.act(of(1, 2)) - x.s.cross(a2_);
    x.v_dq = v1 - v2;
    const Twist a_dq = a1 - a2 + v1.cross(v2_) + v1_.cross(v2);
    x.a_dq = a_dq + turned(lagOf(x.v_dq, v1), v_) + turned(lag_, x.v_dq);
    x.a_dv = of(0, 3) - X_.act(of(1, 3)) + x.s1.cross(v2_) + v1_.cross(x.s2) + turned(lagOf(x.s, x.s1), v_) + turned(lag_, x.s);
    return x;
  }

  /// The first two alone.
  std::pair<Twist, Twist> motions(int k) const {
    const auto of = [&](int e) { return moves_[e] ? read(columns_[e][1] + 6 * k) : Twist{}; };
    return {of(0), X_.act(of(1))};
  }

  const Mat3<double>& axes() const { return axes_; }
  const Twist& velocity() const { return v_; }
  const Twist& rate() const { return rate_; }
  /// Component of a vector in the constraint's axes.
  double along(const Twist& x, int direction) const { return dot(axes_.col(direction % 3), direction < 3 ? x.linear : x.angular); }

  /// Of the error of position, in axes of 1, beside the turning of the axes.
  Twist errorChange(const Column& x) const {
    Twist out;
    // Of the first origin from the second, both fixed to their bodies.
    const Vec second = x.s2.linear + cross(x.s2.angular, X_.p);
    out.linear = x.s1.linear - second - cross(x.s1.angular, error_.linear);
    if (c_.turnsFreely()) return out;
    for (int k = 0; k < 3; ++k)
      if (c_.free[at(3 + k)]) {
        out.angular = tiltChange(k, x.s.angular);
        return out;
      }
    out.angular = Jlog3(error_.angular) * x.s.angular;
    return out;
  }
  const Twist& error() const { return error_; }

 private:
  Vec lagOf(const Twist& relative, const Twist& first) const {
    if (c_.axes == ConstraintAxes::OTHER) return relative.angular;
    return c_.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED || point_ ? first.angular : Vec{};
  }
  static Vec axis(int k) {
    Vec e;
    e[k] = 1;
    return e;
  }
  /// angle / sine and its derivative by the cosine.
  struct Quotient {
    double value, rate;
  };
  static Quotient quotient(double cosine) {
    const double c = std::clamp(cosine, -1.0, 1.0), s2 = 1 - c * c;
    // Near 0: angle / sine = 1 + x^2 / 6 + 7 x^4 / 360, and cosine = 1 - x^2 / 2 + ...; both to rounding where s2 < 1e-8.
    if (s2 < 1e-8 && c > 0) return {1 + (1 - c) / 3, -1.0 / 3};
    const double s = std::sqrt(s2), ratio = std::atan2(s, c) / s;
    return {ratio, (c * ratio - 1) / s2};
  }
  Vec tiltChange(int k, const Vec& turning) const {
    const Vec first = axis(k), second = X_.R.col(k), change = cross(second, turning);  // of the second, seen from 1
    const Quotient x = quotient(dot(first, second));
    return x.value * cross(change, first) + (x.rate * dot(change, first)) * cross(second, first);
  }

  const PackedFrameConstraint& c_;
  bool moves_[2];
  const double* columns_[2][5] = {};
  SE3<double> X_;  ///< pose of the second frame in 1
  Twist v1_, v2_, a1_, a2_, v_, a_, rate_, error_;
  Mat3<double> axes_;
  Vec lag_;
  bool point_;
};

/// The wrench of the rows' forces in axes of 1, at its origin.
Force<double> wrenchOf(const PackedFrameConstraint& f, const Mat3<double>& axes, const double* lambda) {
  Force<double> out;
  int row = f.row;
  for (int k = 0; k < 6; ++k) {
    if (f.free[at(k)]) continue;
    (k < 3 ? out.linear : out.angular) += lambda[row++] * axes.col(k % 3);
  }
  return out;
}

const TypeBatch& batchOf(const CompactImpl& m, int body) { return m.batches[at(m.index[at(body)].batch)]; }

/// Constraints of joints; q, v, a expanded, results by the user's degrees of freedom.
void linearizeJointRows(const CompactImpl& m, const DataImpl& d, const ConstraintDataImpl& c, const double* q, RowQuantity quantity,
                        const RowDerivatives& out) {
  const PackedConstraints& packed = c.set.impl();
  const std::ptrdiff_t rows = packed.rows, nv = m.nv;
  const bool acceleration = quantity == RowQuantity::acceleration;
  const double *v = d.kinematics_v, *a = d.kinematics_a;
  for (const PackedJointCoupling& k : packed.couplings) {
    const BodyIndex &follower = m.index[at(k.body)], &master = m.index[at(k.master)];
    const TypeBatch& batch = batchOf(m, k.master);
    double f[4];
    const double x = coordinateOf(*batch.type, batch.constants.data() + master.slot, batch.count, q + master.idx_q);
    k.type->evaluate(k.constants.data(), static_cast<int>(k.constants.size()), x, f);
    const std::ptrdiff_t s = rows * follower.user_v + k.row, t = rows * master.user_v + k.row;
    const double vm = v[master.idx_v], am = a[master.idx_v];
    const Baumgarte& b = k.baumgarte;
    out.J[s] = 1;
    out.J[t] = -f[1];
    if (acceleration) {
      out.by_q[s] = b.position;
      out.by_q[t] = -f[2] * am - f[3] * vm * vm - b.velocity * f[2] * vm - b.position * f[1];
      out.by_v[s] = b.velocity;
      out.by_v[t] = -2 * f[2] * vm - b.velocity * f[1];
    } else {
      out.by_q[t] = -f[2] * vm;
    }
    out.force_by_q[(nv + 1) * master.user_v] += f[2] * c.lambda[k.row];
  }
  for (const PackedJointLock& k : packed.locks) {
    const BodyIndex& x = m.index[at(k.body)];
    const Baumgarte& b = k.baumgarte;
    double J_q[36], J_v[36], difference[6];
    if (!k.configuration.empty() && b.position > 0) {
      const TypeBatch& batch = batchOf(m, k.body);
      ConfigurationBatch<double> call;
      call.count = 1;
      call.constants = batch.constants.data() + x.slot;
      call.constants_stride = batch.count;
      call.q_stride = call.v_stride = call.j_stride = 1;
      call.q0 = k.configuration.data();
      call.q1 = q + x.idx_q;
      call.v_out = difference;
      call.J_q = J_q;
      call.J_v = J_v;
      batch.type->difference(call);
    }
    for (int r = 0; r < k.rows; ++r) {
      out.J[rows * (x.user_v + r) + k.row + r] = 1;
      if (!acceleration) continue;
      out.by_v[rows * (x.user_v + r) + k.row + r] = b.velocity;
      for (int l = 0; l < k.rows && b.position > 0; ++l) out.by_q[rows * (x.user_v + l) + k.row + r] = b.position * J_v[k.rows * r + l];
    }
  }
}

}  // namespace

void linearizeRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const double* q, RowQuantity quantity, const RowDerivatives& out) {
  const CompactImpl& m = model.impl();
  const PackedConstraints& packed = c.set.impl();
  const std::ptrdiff_t rows = packed.rows, nv = m.nv;
  const bool acceleration = quantity == RowQuantity::acceleration;
  for (double* matrix : {out.by_q, out.by_v, out.J})
    if (matrix) std::fill_n(matrix, rows * nv, 0.0);
  for (std::size_t i = 0; i < packed.frames.size(); ++i) {
    const PackedFrameConstraint& f = packed.frames[i];
    const RelativeMotion x(m, d, c, f, c.frames[i]);
    const Force<double> wrench = wrenchOf(f, x.axes(), c.lambda);
    const Baumgarte& b = f.baumgarte;
    for (const int k : f.dofs) {
      const RelativeMotion::Column s = x.column(k);
      const Twist v_dq = s.v_dq + turned(s.lag, x.velocity());
      const Twist a_dq = acceleration ? s.a_dq + turned(s.lag, x.rate()) : Twist{};
      const Twist error = b.position > 0 && acceleration ? x.errorChange(s) + turned(s.lag, x.error()) : Twist{};
      const Twist by_q = acceleration ? a_dq + b.velocity * v_dq + b.position * error : v_dq;
      const Twist by_v = acceleration ? s.a_dv + b.velocity * s.s : Twist{};
      eachDirection(f, [&](int row, int direction) {
        const std::ptrdiff_t entry = rows * k + row;
        out.by_q[entry] = x.along(by_q, direction);
        out.J[entry] = x.along(s.s, direction);
        if (out.by_v) out.by_v[entry] = x.along(by_v, direction);
      });
    }
    // The force turns with its axes, where its derivative so far has it turn with each body, and its point moves on the second.
    if (!f.forceTurns()) continue;
    for (const int k : f.dofs) {
      const RelativeMotion::Column s = x.column(k);
      const auto turnedWrench = [&](const Vec& w) { return Force<double>{cross(w, wrench.linear), cross(w, wrench.angular)}; };
      const Force<double> first = turnedWrench(-s.lag);
      Force<double> second = turnedWrench(s.s.angular - s.lag);
      second.angular += cross(s.s.linear, wrench.linear);
      for (const int l : f.dofs) {
        const auto [s1, s2] = x.motions(l);
        out.force_by_q[nv * k + l] += dot(s2, second) - dot(s1, first);
      }
    }
  }
  linearizeJointRows(m, d, c, q, quantity, out);
}

void rowForcesOnBodies(const CompactModel& model, const DataImpl& d, const ConstraintDataImpl& c, Force<double>* fext) {
  const CompactImpl& m = model.impl();
  std::fill_n(fext, m.joints.size(), Force<double>{});
  for (std::size_t k = 0; k < c.set.impl().frames.size(); ++k) {
    const PackedFrameConstraint& f = c.set.impl().frames[k];
    const FrameRows& x = c.frames[k];
    const Force<double> wrench = wrenchOf(f, x.axes, c.lambda);
    const auto add = [&](int e, const Force<double>& at_point) {
      if (f.body[e] == 0) return;
      const Mat3<double>& R = d.R[f.body[e]];
      const Vec moment = at_point.angular + cross(x.lever[e], at_point.linear);
      const std::size_t joint = at(m.index[at(f.body[e])].joint);
      fext[joint] += m.user_frame[joint].actInv(Force<double>{transposeTimes(R, at_point.linear), transposeTimes(R, moment)});
    };
    add(0, wrench);
    add(1, {-(x.turn * wrench.linear), -(x.turn * wrench.angular)});
  }
}

}  // namespace dyn
