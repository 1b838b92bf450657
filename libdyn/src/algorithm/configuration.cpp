// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/random_numbers.hpp"
#include "at.hpp"
#include "joint/coordinate.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/states.hpp>
#include <dyn/error.hpp>
#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

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

using detail::StatesView;

/// Writes a random configuration, with numbers of `generator`.
void drawConfiguration(const CompactModel& model, RandomNumbers& generator, double* q) {
  const CompactImpl& m = model.impl();
  // std::mt19937_64 gives the same numbers everywhere; std::uniform_real_distribution does not.
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
  detail::neutral(model, q);
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

/// States that one call of a joint type evaluates.
constexpr int states_together = 16;

/// The columns of an argument. One column counts for all states.
struct StateColumns {
  const double* first;
  std::ptrdiff_t step;
  const double* operator[](std::ptrdiff_t state) const { return first + state * step; }
};
StateColumns readColumns(const char* function, const char* name, const StatesView<double>& x, std::ptrdiff_t rows, std::ptrdiff_t states) {
  if (x.rows != rows || (x.cols != states && x.cols != 1))
    throw Error(ErrorCode::size, std::string(function) + ": " + name + " is " + std::to_string(x.rows) + " x " + std::to_string(x.cols) +
                                     ", it must be " + std::to_string(rows) + " x " + std::to_string(states) + ", or have one column");
  if (x.data == nullptr && rows * states > 0) throw Error(ErrorCode::argument, std::string(function) + ": " + name + " is a null pointer");
  return {x.data, x.cols == states ? x.stride : 0};
}

/// Numbers of one joint in some states, as types read them: the states of a number lie side by side.
class Tile {
 public:
  const double* read(const StateColumns& from, std::ptrdiff_t first, int count, int row, int size) {
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < size; ++k) numbers_[k * states_together + l] = from[first + l][row + k];
    return numbers_;
  }
  /// Returns whether all numbers are finite.
  bool write(const MatrixOut& to, std::ptrdiff_t first, int count, int row, int size) const {
    double zeros = 0;
    for (int l = 0; l < count; ++l)
      for (int k = 0; k < size; ++k) {
        to.column(first + l)[row + k] = numbers_[k * states_together + l];
        zeros += 0 * numbers_[k * states_together + l];
      }
    return zeros == 0;
  }
  double* numbers() { return numbers_; }

 private:
  double numbers_[states_together * max_joint_nq];
};

/// Calls add(state, first coordinate, first velocity, count) where velocities are added to coordinates, and joint(type, call, x, first state, count)
/// for each other joint. `joint` returns whether the results are finite. Then calls check(state) for each state, if some are not.
template <class Add, class Joint, class Check>
void inStates(const CompactImpl& m, std::ptrdiff_t states, const Add& add, const Joint& joint, const Check& check) {
  bool finite = true;
  for (std::ptrdiff_t first = 0; first < states; first += states_together) {
    const int count = static_cast<int>(std::min<std::ptrdiff_t>(states_together, states - first));
    int q = 0, v = 0, numbers = 0;
    const auto addRun = [&] {
      for (int l = 0; numbers > 0 && l < count; ++l) add(first + l, q, v, numbers);
      numbers = 0;
    };
    for (int i = 1; i < m.bodies(); ++i) {
      const BodyIndex& x = m.index[at(i)];
      if (x.user_v < 0) continue;
      const TypeBatch& batch = m.batches[at(x.batch)];
      if (batch.adds) {
        if (x.user_q != q + numbers || x.user_v != v + numbers) {
          addRun();
          q = x.user_q;
          v = x.user_v;
        }
        numbers += x.nq;
        continue;
      }
      ConfigurationBatch<double> call = batch.placeOf(x.slot).question();
      call.lanes = count;
      call.q_stride = call.v_stride = states_together;
      finite = joint(*batch.type, call, x, first, count) && finite;
    }
    addRun();
  }
  for (std::ptrdiff_t state = 0; !finite && state < states; ++state) check(state);
}

/// How errors name the argument of a state.
std::string ofState(std::ptrdiff_t state, std::ptrdiff_t states, const char* argument) {
  return states == 1 ? argument : "state " + std::to_string(state) + ": " + argument;
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
  std::array<RandomNumbers, 1> generator;
  RandomNumbers::seed<1>(seed, generator);
  drawConfiguration(model, generator[0], q);
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

void integrateStates(const CompactModel& model, StatesView<double> q, StatesView<double> v, const MatrixOut& out) {
  constexpr const char* name = "integrate";
  const CompactImpl& m = model.impl();
  checkShape(name, "the result", out, m.nq, static_cast<int>(out.cols()));
  const StateColumns Q = readColumns(name, "q", q, m.nq, out.cols()), V = readColumns(name, "v", v, m.nv, out.cols());
  Tile start, velocity, end;
  inStates(
      m, out.cols(),
      [&](std::ptrdiff_t state, int iq, int iv, int count) {
        const double *from = Q[state] + iq, *by = V[state] + iv;
        double* const to = out.column(state) + iq;
        for (int k = 0; k < count; ++k) to[k] = from[k] + by[k];
      },
      [&](const JointType& type, ConfigurationBatch<double>& call, const BodyIndex& x, std::ptrdiff_t first, int count) {
        call.q0 = start.read(Q, first, count, x.user_q, x.nq);
        call.v = velocity.read(V, first, count, x.user_v, x.nv);
        call.q_out = end.numbers();
        type.integrate(call);
        return end.write(out, first, count, x.user_q, x.nq);
      },
      [&](std::ptrdiff_t state) { checkConfiguration(ofState(state, out.cols(), "q").c_str(), m, Q[state]); });
}

void differenceStates(const CompactModel& model, StatesView<double> q0, StatesView<double> q1, const MatrixOut& out) {
  constexpr const char* name = "difference";
  const CompactImpl& m = model.impl();
  checkShape(name, "the result", out, m.nv, static_cast<int>(out.cols()));
  const StateColumns Q0 = readColumns(name, "q0", q0, m.nq, out.cols()), Q1 = readColumns(name, "q1", q1, m.nq, out.cols());
  Tile start, end, difference;
  inStates(
      m, out.cols(),
      [&](std::ptrdiff_t state, int iq, int iv, int count) {
        const double *from = Q0[state] + iq, *to = Q1[state] + iq;
        double* const x = out.column(state) + iv;
        for (int k = 0; k < count; ++k) x[k] = to[k] - from[k];
      },
      [&](const JointType& type, ConfigurationBatch<double>& call, const BodyIndex& x, std::ptrdiff_t first, int count) {
        call.q0 = start.read(Q0, first, count, x.user_q, x.nq);
        call.q1 = end.read(Q1, first, count, x.user_q, x.nq);
        call.v_out = difference.numbers();
        type.difference(call);
        return difference.write(out, first, count, x.user_v, x.nv);
      },
      [&](std::ptrdiff_t state) {
        checkConfiguration(ofState(state, out.cols(), "q0").c_str(), m, Q0[state]);
        checkConfiguration(ofState(state, out.cols(), "q1").c_str(), m, Q1[state]);
      });
}

void interpolateStates(const CompactModel& model, StatesView<double> q0, StatesView<double> q1, StatesView<double> t, const MatrixOut& out) {
  constexpr const char* name = "interpolate";
  const CompactImpl& m = model.impl();
  checkShape(name, "the result", out, m.nq, static_cast<int>(out.cols()));
  const StateColumns Q0 = readColumns(name, "q0", q0, m.nq, out.cols()), Q1 = readColumns(name, "q1", q1, m.nq, out.cols());
  const StateColumns T = readColumns(name, "t", t, 1, out.cols());
  Tile start, end, difference;
  inStates(
      m, out.cols(),
      [&](std::ptrdiff_t state, int iq, int, int count) {
        const double *from = Q0[state] + iq, *to = Q1[state] + iq, share = *T[state];
        double* const x = out.column(state) + iq;
        for (int k = 0; k < count; ++k) x[k] = from[k] + (to[k] - from[k]) * share;
      },
      [&](const JointType& type, ConfigurationBatch<double>& call, const BodyIndex& x, std::ptrdiff_t first, int count) {
        call.q0 = start.read(Q0, first, count, x.user_q, x.nq);
        call.q1 = end.read(Q1, first, count, x.user_q, x.nq);
        call.v_out = difference.numbers();
        type.difference(call);
        for (int k = 0; k < x.nv; ++k)
          for (int l = 0; l < count; ++l) difference.numbers()[k * states_together + l] *= *T[first + l];
        call.v = difference.numbers();
        call.v_out = nullptr;
        call.q_out = end.numbers();
        type.integrate(call);
        return end.write(out, first, count, x.user_q, x.nq);
      },
      [&](std::ptrdiff_t state) {
        checkConfiguration(ofState(state, out.cols(), "q0").c_str(), m, Q0[state]);
        checkConfiguration(ofState(state, out.cols(), "q1").c_str(), m, Q1[state]);
      });
}

void normalizeStates(const CompactModel& model, StatesView<double> q, const MatrixOut& out) {
  constexpr const char* name = "normalize";
  const CompactImpl& m = model.impl();
  checkShape(name, "the result", out, m.nq, static_cast<int>(out.cols()));
  const StateColumns Q = readColumns(name, "q", q, m.nq, out.cols());
  Tile given, normal;
  inStates(
      m, out.cols(), [&](std::ptrdiff_t state, int iq, int, int count) { std::copy_n(Q[state] + iq, count, out.column(state) + iq); },
      [&](const JointType& type, ConfigurationBatch<double>& call, const BodyIndex& x, std::ptrdiff_t first, int count) {
        call.q0 = given.read(Q, first, count, x.user_q, x.nq);
        call.q_out = normal.numbers();
        type.normalize(call);
        return normal.write(out, first, count, x.user_q, x.nq);
      },
      [&](std::ptrdiff_t state) { checkConfiguration(ofState(state, out.cols(), "q").c_str(), m, Q[state]); });
}

void randomStates(const CompactModel& model, std::uint64_t seed, const MatrixOut& out) {
  checkShape("randomConfiguration", "the result", out, model.nq(), static_cast<int>(out.cols()));
  constexpr int beside = 4;
  std::array<RandomNumbers, beside> generators;
  for (std::ptrdiff_t first = 0; first < out.cols(); first += beside) {
    RandomNumbers::seed<beside>(seed + static_cast<std::uint64_t>(first), generators);
    for (std::ptrdiff_t k = first; k < std::min(first + beside, out.cols()); ++k)
      drawConfiguration(model, generators[at(static_cast<int>(k - first))], out.column(k));
  }
}

}  // namespace detail

}  // namespace dyn
