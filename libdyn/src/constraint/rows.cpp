// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/rows.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "at.hpp"
#include "kernels/constraint/frame_rows.hpp"
#include "kernels/isa/constraint_table.hpp"

#include <algorithm>

namespace dyn {

namespace {

/// The unit forces of rows on joints: calls use(row, dof, projection), where dof is the place of a degree of freedom among those of the constraints'
/// bodies.
template <class Use>
void eachProjection(const CompactImpl& m, const PackedConstraints& c, const double* q, Use&& use) {
  const auto placeOf = [&](int body) { return c.bodies[at(c.body_at[at(body)])].dof; };
  Coordinates coordinates;
  for (const PackedJointCoupling& k : c.couplings) {
    double f[4];
    evaluateCoupling(m, k, coordinates, q, f);
    use(k.row, placeOf(k.body), 1.0);
    use(k.row, placeOf(k.master), -f[1]);
  }
  for (const PackedJointLock& k : c.locks)
    for (int r = 0; r < k.rows; ++r) use(k.row + r, placeOf(k.body) + r, 1.0);
}

}  // namespace

void differenceOf(const CompactImpl& m, int body, const double* from, const double* to, double* v, double* J_from, double* J_to) {
  const BodyIndex& x = m.index[at(body)];
  const TypeBatch& batch = m.batches[at(x.batch)];
  ConfigurationBatch<double> b = batch.placeOf(x.slot).question();
  b.q0 = from;
  b.q1 = to;
  b.v_out = v;
  b.J_q = J_from;
  b.J_v = J_to;
  batch.type->difference(b);
}

void locateRows(const CompactImpl& m, const PackedConstraints& c, const double* q, const double* v, kernels::RowRates rates,
                kernels::FrameRows* frames, const kernels::RowMotion& rows, kernels::ConstraintWorkspace& x) {
  kernels::constraintKernels().placeFrames(m, c, rates, frames, rows, x);
  if (!c.actsOnJoints()) return;
  std::fill_n(x.projection, x.room * static_cast<std::ptrdiff_t>(c.dofs.size()), 0.0);
  locateJointRows(m, c, q, v, rows, x.projection, x.room, 1);
}

void locateJointRows(const CompactImpl& m, const PackedConstraints& c, const double* q, const double* v, const kernels::RowMotion& rows,
                     double* projection, std::ptrdiff_t room, int step) {
  const auto put = [&](int row, double velocity, double bias, double error, const Baumgarte& b) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(row) * step;
    rows.velocity[at] = velocity;
    rows.bias[at] = bias;
    rows.error[at] = error;
    rows.drift[at] = bias + b.velocity * velocity + b.position * error;
    rows.fall[at] = 0;
  };
  Coordinates coordinates;
  for (const PackedJointCoupling& k : c.couplings) {
    double f[4], q_wanted[max_joint_nq], error;
    evaluateCoupling(m, k, coordinates, q, f);
    const BodyIndex &dependent = m.index[at(k.body)], &master = m.index[at(k.master)];
    const double vm = v ? v[master.idx_v] : 0.0;
    setCoordinate(m, k.body, coordinates, f[0], q_wanted);
    differenceOf(m, k.body, q_wanted, q + dependent.idx_q, &error);
    put(k.row, (v ? v[dependent.idx_v] : 0.0) - f[1] * vm, -f[2] * vm * vm, error, k.baumgarte);
  }
  for (const PackedJointLock& k : c.locks) {
    const BodyIndex& body = m.index[at(k.body)];
    double error[max_joint_nv] = {};
    if (!k.configuration.empty()) differenceOf(m, k.body, k.configuration.data(), q + body.idx_q, error);
    for (int r = 0; r < k.rows; ++r) put(k.row + r, v ? v[body.idx_v + r] : 0.0, 0, error[r], k.baumgarte);
  }
  eachProjection(m, c, q, [&](int row, int dof, double share) { projection[(room * dof + row) * step] += share; });
}

void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* projections) {
  std::fill_n(bodies, c.bodies.size(), Force<double>{});
  std::fill_n(projections, c.dofs.size(), 0.0);
  for (std::size_t i = 0; i < c.frames.size(); ++i)
    for (int e = 0; e < 2; ++e)
      if (const int body = c.frames[i].body[e]; body > 0) bodies[c.body_at[at(body)]] += kernels::forceOnBody(c.frames[i], frames[i], lambda, e);
  eachProjection(m, c, q, [&](int row, int dof, double share) { projections[dof] += lambda[row] * share; });
}

void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q,
                      const kernels::ConstraintWorkspace& x, const double* ddq, double* out) {
  kernels::constraintKernels().frameAccelerations(c, frames, x, out);
  if (!c.actsOnJoints()) return;
  for (const PackedJointCoupling& k : c.couplings) out[k.row] = 0;
  for (const PackedJointLock& k : c.locks) std::fill_n(out + k.row, k.rows, 0.0);
  // The projections of a row's unit force are also the row's Jacobian.
  eachProjection(m, c, q, [&](int row, int dof, double share) { out[row] += share * ddq[c.dofs[at(dof)]]; });
}

}  // namespace dyn
