// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/linearize.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "at.hpp"
#include "kernels/constraint/frame_rows.hpp"
#include "kernels/isa/constraint_table.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

using Vec = Vec3<double>;

/// angle / sine of an angle, and its derivative by the cosine.
struct Quotient {
  double value, rate;
};
Quotient quotient(double cosine) {
  const double c = std::clamp(cosine, -1.0, 1.0), s2 = 1 - c * c;
  // Near 0: angle / sine = 1 + x^2 / 6 + 7 x^4 / 360, and cosine = 1 - x^2 / 2 + ...; both to rounding where s2 < 1e-8.
  if (s2 < 1e-8 && c > 0) return {1 + (1 - c) / 3, -1.0 / 3};
  const double s = std::sqrt(s2), ratio = std::atan2(s, c) / s;
  return {ratio, (c * ratio - 1) / s2};
}

/// The derivative of the angular part of a constraint's error, in axes that turn with its first frame, by the rotation of the first body against the
/// second. All in the aligned axes of the first body's tree.
Mat3<double> errorByTurning(const PackedFrameConstraint& f, const Mat3<double>& own, const Mat3<double>& other, const kernels::FrameRows& x) {
  const Mat3<double> first = own * f.placement[0].R, second = transpose(x.turn) * (other * f.placement[1].R);
  if (f.turnsFreely()) return {};
  for (int k = 0; k < 3; ++k)
    if (f.free[at(3 + k)]) {
      const Vec here = first.col(k), there = second.col(k), normal = cross(there, here);
      const Quotient q = quotient(dot(here, there));
      Mat3<double> out;
      for (int column = 0; column < 3; ++column) {
        Vec turning;
        turning[column] = 1;
        const Vec change = cross(there, turning);  // of the second frame's axis, as seen from the first
        const Vec tilt = q.value * cross(change, here) + (q.rate * dot(change, here)) * normal;
        for (int row = 0; row < 3; ++row) out(row, column) = tilt[row];
      }
      return out;
    }
  return first * Jlog3(transposeTimes(first, x.error.angular)) * transpose(first);
}

/// Adds the columns of dependent joints to those of their masters.
void foldColumns(const CompactImpl& m, const DataImpl& d, const PackedFrameConstraint& f, kernels::StoredColumn* columns) {
  const auto slotOf = [&](int body) {
    const int dof = m.index[at(body)].idx_v;
    const auto found = std::lower_bound(f.slots.begin(), f.slots.end(), dof, [](const auto& slot, int x) { return slot.dof < x; });
    return found != f.slots.end() && found->dof == dof ? columns + (found - f.slots.begin()) : nullptr;
  };
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const kernels::StoredColumn* dependent = slotOf(m.couplings[k].body);
    if (dependent == nullptr) continue;
    kernels::StoredColumn& master = *slotOf(m.couplings[k].master);
    // The same formulas as in DependentJoints::foldDerivatives().
    const std::ptrdiff_t t = m.index[at(m.couplings[k].master)].idx_v;
    const double v = d.vx[t];
    const Vectored G = d.G[k], dGv = d.dG[k] * v, twice = 2 * d.dG[k] * v, more = d.dG[k] * d.ax[t] + d.ddG[k] * v * v;
    master.velocity += G * dependent->velocity + dGv * dependent->displacement;
    master.acceleration += G * dependent->acceleration + dGv * dependent->rate + more * dependent->displacement;
    master.rate += G * dependent->rate + twice * dependent->displacement;
    master.displacement += G * dependent->displacement;
  }
}

/// Computes the motions of a constraint's point on its two bodies, and writes their columns to c.columns.
void pointMotions(const CompactImpl& m, const DataImpl& d, const ConstraintDataImpl& c, const PackedFrameConstraint& f, const kernels::FrameRows& x,
                  kernels::PointMotion* points) {
  for (int e = 0; e < 2; ++e) {
    // Gravity counts as an acceleration of the world.
    points[e] = {{}, {-m.gravity, {}}};
    if (f.body[e] > 0) {
      if (f.path[e].size() < f.slots.size()) std::fill_n(c.columns[e], f.slots.size(), kernels::StoredColumn{});
      points[e] = kernels::constraintKernels().pointColumns(m, d.derivatives, f.body[e], x.arm[e], f.path[e].data(), c.columns[e]);
      if (!m.couplings.empty()) foldColumns(m, d, f, c.columns[e]);
    }
  }
  for (Motion<double>* motion : {&points[1].velocity, &points[1].acceleration}) *motion = kernels::turnedBack(x.turn, *motion);
}

/// The derivatives of the rows of constraints on joints, by the user's degrees of freedom.
void linearizeJointRows(const CompactImpl& m, const ConstraintDataImpl& c, const Inputs& state, bool feedback, const kernels::RowDerivatives& out) {
  const PackedConstraints& packed = c.set.impl();
  Coordinates coordinates;
  for (const PackedJointCoupling& k : packed.couplings) {
    const BodyIndex &dependent = m.index[at(k.body)], &master = m.index[at(k.master)];
    double f[4];
    evaluateCoupling(m, k, coordinates, state.q, f);
    const std::ptrdiff_t s = out.rows * dependent.user_v + k.row, t = out.rows * master.user_v + k.row;
    const double vm = state.v[master.idx_v], am = state.a[master.idx_v];
    const Baumgarte b = feedback ? k.baumgarte : Baumgarte{};
    out.J[s] = 1;
    out.J[t] = -f[1];
    out.by_q[s] = b.position;
    out.by_q[t] = -f[2] * am - f[3] * vm * vm - b.velocity * f[2] * vm - b.position * f[1];
    out.by_v[s] = b.velocity;
    out.by_v[t] = -2 * f[2] * vm - b.velocity * f[1];
    out.force_by_q[(out.nv + 1) * master.user_v] += f[2] * c.lambda[k.row];
  }
  for (const PackedJointLock& k : packed.locks) {
    const BodyIndex& x = m.index[at(k.body)];
    const Baumgarte b = feedback ? k.baumgarte : Baumgarte{};
    double J_q[36], J_v[36] = {}, difference[6];
    if (!k.configuration.empty() && b.position > 0) differenceOf(m, k.body, k.configuration.data(), state.q + x.idx_q, difference, J_q, J_v);
    for (int r = 0; r < k.rows; ++r)
      for (int l = 0; l < k.rows; ++l) {
        const std::ptrdiff_t entry = out.rows * (x.user_v + l) + k.row + r;
        out.J[entry] = r == l ? 1 : 0;
        out.by_v[entry] = r == l ? b.velocity : 0;
        out.by_q[entry] = b.position * J_v[k.rows * r + l];
      }
  }
}

}  // namespace

void linearizeRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const Inputs& state, bool feedback,
                   const kernels::RowDerivatives& out) {
  const CompactImpl& m = model.impl();
  const PackedConstraints& packed = c.set.impl();
  for (std::size_t i = 0; i < packed.frames.size(); ++i) {
    const PackedFrameConstraint& f = packed.frames[i];
    kernels::RowState x{c.frames[i], {}, {}, {}, kernels::wrenchOf(f, c.frames[i], c.lambda)};
    pointMotions(m, d, c, f, c.frames[i], x.points);
    if (feedback) x.gains = f.baumgarte;
    if (x.gains.position > 0)
      x.error_by_turning = errorByTurning(f, c.workspace.stateOf(packed, f.body[0]).R, c.workspace.stateOf(packed, f.body[1]).R, c.frames[i]);
    kernels::constraintKernels().rowDerivatives(f, x, c.columns, c.turning, out);
  }
  linearizeJointRows(m, c, state, feedback, out);
}

void rowForcesOnBodies(const CompactModel& model, const ConstraintDataImpl& c, Force<double>* fext) {
  const CompactImpl& m = model.impl();
  std::fill_n(fext, m.joints.size(), Force<double>{});
  for (std::size_t k = 0; k < c.set.impl().frames.size(); ++k) {
    const PackedFrameConstraint& f = c.set.impl().frames[k];
    const kernels::FrameRows& x = c.frames[k];
    for (int e = 0; e < 2; ++e) {
      if (f.body[e] == 0) continue;
      const Mat3<double>& R = c.workspace.stateOf(c.set.impl(), f.body[e]).R;
      const Force<double> force = kernels::forceOnBody(f, x, c.lambda, e);
      const std::size_t joint = at(m.index[at(f.body[e])].joint);
      fext[joint] += m.user_frame[joint].actInv(Force<double>{transposeTimes(R, force.linear), transposeTimes(R, force.angular)});
    }
  }
}

}  // namespace dyn
