// SPDX-License-Identifier: BSD-2-Clause
#include "integrate/chart.hpp"

#include "algorithm/support/turning.hpp"

#include <algorithm>

namespace dyn {

/// Derivatives of one joint, nv x nv, row-major.
struct Chart::Blocks {
  double by_q[max_joint_nv * max_joint_nv], by_v[max_joint_nv * max_joint_nv];
};

namespace {

/// out = B^T x if transposed, else B x.
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
  for (const TypeBatch& batch : m.batches)
    for (int k = 0; k < batch.count; ++k) {
      const BodyIndex& x = m.index[static_cast<std::size_t>(batch.bodies[static_cast<std::size_t>(k)])];
      if (x.user_v < 0) continue;
      const Joint joint{batch.placeOf(k), x.user_q, x.user_v, x.nv, slidingAndTurning(batch.shape)};
      if (batch.adds) {
        added_.push_back({x.user_q, x.user_v, x.nv});
        continue;
      }
      turned_.push_back(joint);
      // The chart of a rotation about one axis has the rate v. The rate of a dense joint is known only to its type.
      if (x.nv > 1 || batch.shape == Shape::dense) curved_.push_back(joint);
    }
  std::sort(added_.begin(), added_.end(), [](const Run& a, const Run& b) { return a.q < b.q; });
  std::vector<Run> joined;
  for (const Run& run : added_) {
    const bool follows = !joined.empty() && joined.back().q + joined.back().count == run.q && joined.back().v + joined.back().count == run.v;
    if (follows) {
      joined.back().count += run.count;
    } else {
      joined.push_back(run);
    }
  }
  added_ = std::move(joined);
}

ConfigurationBatch<double> Chart::callOf(const Joint& joint, Blocks& blocks) {
  ConfigurationBatch<double> call = joint.place.question();
  call.J_q = blocks.by_q;
  call.J_v = blocks.by_v;
  return call;
}

void Chart::pointOf(const Joint& joint, const double* q0, const double* u, double* q) {
  ConfigurationBatch<double> call = joint.place.question();
  call.q0 = q0;
  call.v = u;
  call.q_out = q;
  joint.place.type->integrate(call);
}

void Chart::add(const double* q0, const double* u, double* q) const {
  for (const Run& run : added_)
    for (int k = 0; k < run.count; ++k) q[run.q + k] = q0[run.q + k] + u[run.v + k];
}

void Chart::point(const double* q0, const double* u, double* q) const {
  add(q0, u, q);
  for (const Joint& joint : turned_) pointOf(joint, q0 + joint.q, u + joint.v, q + joint.q);
}

void Chart::rate(const double* q0, const double* q, const double* v, double* du) const {
  std::copy_n(v, model_.nv(), du);
  for (const Joint& joint : curved_) {
    Blocks blocks;
    ConfigurationBatch<double> call = callOf(joint, blocks);
    call.q0 = q0 + joint.q;
    call.q1 = q + joint.q;
    joint.place.type->difference(call);
    multiply(blocks.by_v, joint.nv, false, v + joint.v, du + joint.v);
  }
}

void Chart::pointInHeldAxes(const double* q0, const double* u, double* v, double* q) const {
  add(q0, u, q);
  for (const Joint& joint : turned_) {
    const double *way = u + joint.v, *start = q0 + joint.q;
    double* end = q + joint.q;
    if (joint.linear == 0) {
      pointOf(joint, start, way, end);
      continue;
    }
    double straight[max_joint_nv] = {}, turn[max_joint_nv] = {}, middle[max_joint_nq];
    std::copy_n(way, joint.linear, straight);
    std::copy(way + joint.linear, way + joint.nv, turn + joint.linear);
    pointOf(joint, start, straight, middle);
    pointOf(joint, middle, turn, end);
    turnAxes(joint.linear, turn, v + joint.v);
  }
}

void Chart::midpointMaps(const double* u, double* momentum, const double* force, double* at_start, double* at_end) const {
  std::copy_n(force, model_.nv(), at_start);
  std::copy_n(force, model_.nv(), at_end);
  for (const Joint& joint : curved_) {
    Blocks end, middle;
    double start_q[max_joint_nq], end_q[max_joint_nq], half[max_joint_nv];
    // The difference is taken about neutral: between positions far from the origin rounding would swamp the step.
    neutralOf(joint.place, start_q);
    pointOf(joint, start_q, u + joint.v, end_q);
    ConfigurationBatch<double> log = callOf(joint, end);
    log.q0 = start_q;
    log.q1 = end_q;
    joint.place.type->difference(log);
    for (int k = 0; k < joint.nv; ++k) half[k] = 0.5 * u[joint.v + k];
    ConfigurationBatch<double> exp = callOf(joint, middle);
    exp.q0 = start_q;
    exp.v = half;
    joint.place.type->integrate(exp);
    double *p = momentum + joint.v, *start = at_start + joint.v, *stop = at_end + joint.v;
    multiply(middle.by_q, joint.nv, true, p, p);
    multiply(end.by_v, joint.nv, true, p, p);
    multiply(middle.by_v, joint.nv, true, stop, stop);
    multiply(end.by_v, joint.nv, true, stop, stop);
    multiply(middle.by_q, joint.nv, true, stop, start);
  }
}

}  // namespace dyn
