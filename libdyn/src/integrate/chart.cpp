#include "integrate/chart.hpp"

#include "algorithm/inputs.hpp"

#include <algorithm>

namespace dyn {

/// nv x nv, row-major.
struct Chart::Blocks {
  double by_q[max_joint_nv * max_joint_nv], by_v[max_joint_nv * max_joint_nv];
};

namespace {

/// out = B^T x, or B x.
void multiply(const double* B, int n, bool transposed, const double* x, double* out) {
  double sum[max_joint_nv];
  for (int r = 0; r < n; ++r) {
    sum[r] = 0;
    for (int c = 0; c < n; ++c) sum[r] += (transposed ? B[c * n + r] : B[r * n + c]) * x[c];
  }
  std::copy_n(sum, n, out);
}

}  // namespace

Chart::Chart(const CompactModel& model) : model_(model) {
  const CompactImpl& m = model_.impl();
  for (const TypeBatch& batch : m.batches) {
    if (!(batch.type->info().closed_forms & closed_configuration)) continue;
    for (int k = 0; k < batch.count; ++k) {
      const BodyIndex& x = m.index[static_cast<std::size_t>(batch.bodies[static_cast<std::size_t>(k)])];
      // One coordinate's exponential along itself has derivative one, however it is written.
      if (x.user_v >= 0 && x.nv > 1) curved_.push_back({batch.type, batch.constants.data() + k, batch.count, x.user_q, x.user_v, x.nv});
    }
  }
}

ConfigurationBatch<double> Chart::callOf(const CurvedJoint& joint, Blocks& blocks) {
  ConfigurationBatch<double> call;
  call.count = 1;
  call.constants = joint.constants;
  call.constants_stride = joint.constants_stride;
  call.q_stride = call.v_stride = call.j_stride = 1;
  call.J_q = blocks.by_q;
  call.J_v = blocks.by_v;
  return call;
}

void Chart::point(const double* q0, const double* u, double* q) const { integrateSound(model_.impl(), q0, u, q); }

void Chart::rate(const double* q0, const double* q, const double* v, double* du) const {
  std::copy_n(v, model_.nv(), du);
  for (const CurvedJoint& joint : curved_) {
    Blocks blocks;
    ConfigurationBatch<double> call = callOf(joint, blocks);
    call.q0 = q0 + joint.q;
    call.q1 = q + joint.q;
    joint.type->difference(call);
    multiply(blocks.by_v, joint.nv, false, v + joint.v, du + joint.v);
  }
}

void Chart::midpointMaps(const double* q0, const double* u, const double* q1, double* momentum, const double* force, double* at_start,
                         double* at_end) const {
  std::copy_n(force, model_.nv(), at_start);
  std::copy_n(force, model_.nv(), at_end);
  for (const CurvedJoint& joint : curved_) {
    Blocks end, middle;
    ConfigurationBatch<double> log = callOf(joint, end);
    log.q0 = q0 + joint.q;
    log.q1 = q1 + joint.q;
    joint.type->difference(log);
    double half[max_joint_nv];
    for (int k = 0; k < joint.nv; ++k) half[k] = 0.5 * u[joint.v + k];
    ConfigurationBatch<double> exp = callOf(joint, middle);
    exp.q0 = q0 + joint.q;
    exp.v = half;
    joint.type->integrate(exp);
    double *p = momentum + joint.v, *start = at_start + joint.v, *stop = at_end + joint.v;
    multiply(middle.by_q, joint.nv, true, p, p);
    multiply(end.by_v, joint.nv, true, p, p);
    multiply(middle.by_v, joint.nv, true, stop, stop);
    multiply(end.by_v, joint.nv, true, stop, stop);
    multiply(middle.by_q, joint.nv, true, stop, start);
  }
}

}  // namespace dyn
