// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "at.hpp"
#include "joint/coordinate.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>
#include <random>

namespace dyn {

namespace {

/// Calls f(batch, call, first coordinate, first velocity) for every independent joint. Joints of a batch with contiguous coordinates share a call.
template <class F>
void eachJoint(const CompactImpl& m, F&& f) {
  for (const TypeBatch& batch : m.batches) {
    const bool together = batch.contiguous && m.couplings.empty();
    for (int k = 0; k < batch.count; k += together ? batch.count : 1) {
      const BodyIndex& x = m.index[at(batch.bodies[at(k)])];
      if (x.user_v < 0) continue;
      ConfigurationBatch<double> call = batch.placeOf(k).question();
      call.count = together ? batch.count : 1;
      call.q_stride = call.v_stride = call.j_stride = together ? batch.count : 1;
      f(batch, call, x.user_q, x.user_v);
    }
  }
}

/// Scatters the nv x nv blocks that `evaluate` writes into a block-diagonal matrix.
template <class F>
void blockDiagonal(const char* algorithm, const CompactImpl& m, ArgumentPosition by, const MatrixOut& J, F&& evaluate) {
  checkShape(algorithm, "J", J, m.nv, m.nv);
  for (int k = 0; k < m.nv; ++k) std::fill_n(J.column(k), m.nv, 0.0);
  for (const TypeBatch& batch : m.batches)
    for (int k = 0; k < batch.count; ++k) {
      const BodyIndex& x = m.index[at(batch.bodies[at(k)])];
      if (x.user_v < 0) continue;
      double Jq[36], Jv[36];
      ConfigurationBatch<double> call = batch.placeOf(k).question();
      call.J_q = Jq;
      call.J_v = Jv;
      evaluate(batch, call, x.user_q, x.user_v);
      const double* block = by == ArgumentPosition::ARG0 ? Jq : Jv;
      for (int r = 0; r < batch.nv; ++r)
        for (int c = 0; c < batch.nv; ++c) J.column(x.user_v + c)[x.user_v + r] = block[r * batch.nv + c];
    }
}

}  // namespace

namespace detail {

void neutral(const CompactModel& model, double* q) {
  eachJoint(model.impl(), [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int) {
    call.q_out = q + iq;
    batch.type->neutral(call);
  });
}

void integrate(const CompactModel& model, VectorView q, VectorView v, const VectorOut& out) {
  checkSize("integrate", "q", q, model.nq());
  checkSize("integrate", "v", v, model.nv());
  checkSize("integrate", "the result", {out.data(), out.size()}, model.nq());
  checkConfiguration("q", model.impl(), q.data);
  eachJoint(model.impl(), [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int iv) {
    call.q0 = q.data + iq;
    call.v = v.data + iv;
    call.q_out = out.data() + iq;
    batch.type->integrate(call);
  });
}

void difference(const CompactModel& model, VectorView q0, VectorView q1, const VectorOut& v) {
  checkSize("difference", "q0", q0, model.nq());
  checkSize("difference", "q1", q1, model.nq());
  checkSize("difference", "the result", {v.data(), v.size()}, model.nv());
  checkConfiguration("q0", model.impl(), q0.data);
  checkConfiguration("q1", model.impl(), q1.data);
  eachJoint(model.impl(), [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int iv) {
    call.q0 = q0.data + iq;
    call.q1 = q1.data + iq;
    call.v_out = v.data() + iv;
    batch.type->difference(call);
  });
}

void normalize(const CompactModel& model, VectorView q, const VectorOut& out) {
  checkSize("normalize", "q", q, model.nq());
  checkSize("normalize", "the result", {out.data(), out.size()}, model.nq());
  const CompactImpl& m = model.impl();
  checkConfiguration("q", m, q.data);
  eachJoint(m, [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int) {
    call.q0 = q.data + iq;
    call.q_out = out.data() + iq;
    batch.type->normalize(call);
  });
}

double distanceFromSpace(const CompactModel& model, VectorView q) {
  checkSize("isNormalized", "q", q, model.nq());
  const CompactImpl& m = model.impl();
  double worst = 0;
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = m.index[at(i)];
    if (x.user_v < 0 || x.nq == x.nv) continue;
    const TypeBatch& batch = m.batches[at(x.batch)];
    const double distance = normalizeJoint(batch.placeOf(x.slot), q.data + x.user_q, nullptr);
    if (!(distance <= worst)) worst = distance;  // NaN stays
  }
  return worst;
}

void randomConfiguration(const CompactModel& model, std::uint64_t seed, double* q) {
  const CompactImpl& m = model.impl();
  std::mt19937_64 generator(seed);
  // mt19937_64 gives the same numbers everywhere; std::uniform_real_distribution does not.
  const auto uniform = [&](double a, double b) {
    const double share = static_cast<double>(generator() >> 11) * 0x1p-53;
    return std::clamp((1 - share) * a + share * b, a, b);  // b - a may overflow
  };
  const auto within = [&](int coordinate, double reach) {
    double lower = m.limits.lower[at(coordinate)], upper = m.limits.upper[at(coordinate)];
    if (!std::isfinite(lower)) lower = std::isfinite(upper) ? std::min(-reach, upper - 1) : -reach;
    if (!std::isfinite(upper)) upper = std::max(reach, lower + 1);
    return uniform(lower, upper);
  };
  neutral(model, q);
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = m.index[at(i)];
    if (x.user_v < 0) continue;
    const TypeBatch& batch = m.batches[at(x.batch)];
    if (x.nq == x.nv) {
      for (int k = 0; k < x.nq; ++k) q[x.user_q + k] = within(x.user_q + k, M_PI);
      continue;
    }
    double v[max_joint_nv], from[max_joint_nq];
    const bool group_with_positions = batch.shape == Shape::free || batch.shape == Shape::planar;
    const int positions = group_with_positions ? (batch.shape == Shape::free ? 3 : 2) : 0;
    for (int k = 0; k < x.nv; ++k) v[k] = k < positions ? 0.0 : uniform(-M_PI, M_PI);
    if (batch.shape == Shape::spherical || batch.shape == Shape::free) {
      // Quaternions are distributed uniformly over their sphere (Shoemake 1992, Graphics Gems III.6).
      const double share = uniform(0, 1), first = std::sqrt(1 - share), second = std::sqrt(share);
      const Vec3<double> w = log3(Quaternion<double>{first * std::sin(v[positions]), first * std::cos(v[positions]),
                                                     second * std::sin(v[positions + 1]), second * std::cos(v[positions + 1])});
      v[positions] = w.x, v[positions + 1] = w.y, v[positions + 2] = w.z;
    }
    std::copy(q + x.user_q, q + x.user_q + x.nq, from);
    ConfigurationBatch<double> call = batch.placeOf(x.slot).question();
    call.q0 = from;
    call.v = v;
    call.q_out = q + x.user_q;
    batch.type->integrate(call);
    for (int k = 0; k < positions; ++k) q[x.user_q + k] = within(x.user_q + k, 1);
  }
}

void dIntegrate(const CompactModel& model, VectorView q, VectorView v, ArgumentPosition by, const MatrixOut& J) {
  checkSize("dIntegrate", "q", q, model.nq());
  checkSize("dIntegrate", "v", v, model.nv());
  checkConfiguration("q", model.impl(), q.data);
  blockDiagonal("dIntegrate", model.impl(), by, J, [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int iv) {
    call.q0 = q.data + iq;
    call.v = v.data + iv;
    batch.type->integrate(call);
  });
}

void dDifference(const CompactModel& model, VectorView q0, VectorView q1, ArgumentPosition by, const MatrixOut& J) {
  checkSize("dDifference", "q0", q0, model.nq());
  checkSize("dDifference", "q1", q1, model.nq());
  checkConfiguration("q0", model.impl(), q0.data);
  checkConfiguration("q1", model.impl(), q1.data);
  blockDiagonal("dDifference", model.impl(), by, J, [&](const TypeBatch& batch, ConfigurationBatch<double>& call, int iq, int) {
    call.q0 = q0.data + iq;
    call.q1 = q1.data + iq;
    batch.type->difference(call);
  });
}

}  // namespace detail

}  // namespace dyn
