// SPDX-License-Identifier: BSD-2-Clause
// A joint type that evaluates graphs, one operation at a time.
//
// The subspace S and its bias (dS/dt) v are derived once, as graphs, from the pose map, in the way in which the SDK derives them.
#include "traced_joint/traced_joint.hpp"

#include <dyn/error.hpp>
#include <dyn_sdk/derive.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cstdio>
#include <deque>
#include <mutex>

namespace dyn {

namespace {

using D = Dual<Traced>;
using DD = Dual<D>;

template <class S>
SE3<S> poseOf(const std::vector<S>& x) {
  return {{{x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8]}}, {x[9], x[10], x[11]}};
}

void write(const Motion<Traced>& m, Traced* out) {
  for (int k = 0; k < 3; ++k) {
    out[k] = m.linear[k];
    out[3 + k] = m.angular[k];
  }
}

/// The graph (q, v, c) -> pose (12), S (6 nv, column after column), (dS/dt) v (6).
Graph kinematicsOf(const TracedJoint& j, const std::optional<Graph>& rates) {
  const int nq = j.nq, nv = j.nv, n = constantCount(j);
  return traceFunction(nq + nv + n, 18 + 6 * nv, [&](const Traced* in, Traced* out) {
    const Traced *q = in, *v = in + nq, *c = in + nq + nv;
    // dq/dt for velocities u at x.
    const auto rate = [&]<class S>(const S* x, const S* u) {
      std::vector<S> arguments(x, x + nq);
      arguments.insert(arguments.end(), u, u + nv);
      for (int i = 0; i < n; ++i) arguments.push_back(S(c[i]));
      return rates ? replay<S>(*rates, arguments) : std::vector<S>(u, u + nv);
    };
    const auto pose = [&]<class S>(std::vector<S> x) {
      for (int i = 0; i < n; ++i) x.push_back(S(c[i]));
      return poseOf(replay<S>(j.pose, x));
    };
    for (int k = 0; k < nv; ++k) {
      std::vector<Traced> unit(static_cast<std::size_t>(nv), Traced(0));
      unit[static_cast<std::size_t>(k)] = 1;
      const std::vector<Traced> dq = rate(q, unit.data());
      std::vector<D> x;
      for (int i = 0; i < nq; ++i) x.emplace_back(q[i], dq[static_cast<std::size_t>(i)]);
      const SE3<D> X = pose(x);
      const sdk::PosePart<Traced> X0(X, [](const D& a) { return a.v; }), X1(X, [](const D& a) { return a.d; });
      write({X0.inAxes(X1.p), X0.turning(X1)}, out + 12 + 6 * k);
    }
    const std::vector<Traced> dq = rate(q, v);
    std::vector<D> along, u;
    for (int i = 0; i < nq; ++i) along.emplace_back(q[i], dq[static_cast<std::size_t>(i)]);
    for (int i = 0; i < nv; ++i) u.emplace_back(v[i], Traced(0));
    const std::vector<D> changing = rate(along.data(), u.data());
    std::vector<DD> x;
    for (std::size_t i = 0; i < static_cast<std::size_t>(nq); ++i) x.emplace_back(D(q[i], dq[i]), D(dq[i], changing[i].d));
    const SE3<DD> X = pose(x);
    const sdk::PosePart<Traced> X0(X, [](const DD& a) { return a.v.v; }), X1(X, [](const DD& a) { return a.v.d; }),
        X2(X, [](const DD& a) { return a.d.d; });
    const SE3<Traced> here = X0.pose();
    for (int k = 0; k < 9; ++k) out[k] = here.R.m[k];
    for (int k = 0; k < 3; ++k) out[9 + k] = here.p[k];
    write({X0.inAxes(X2.p) + X1.inAxes(X1.p), X0.turning(X2)}, out + 12 + 6 * nv);
  });
}

/// Evaluates a graph. Memory is kept for the thread's next call.
template <class S>
class Evaluation {
 public:
  explicit Evaluation(const Graph& graph) : graph_(graph) {
    inputs_.assign(static_cast<std::size_t>(graph.inputs), S(0));
    values_.resize(graph.nodes.size());
  }
  S* inputs() { return inputs_.data(); }
  void run() { replayNodes(graph_, inputs_.data(), values_.data()); }
  const S& operator[](int k) const { return values_[graph_.outputs[static_cast<std::size_t>(k)]]; }

 private:
  const Graph& graph_;
  static thread_local std::vector<S> inputs_, values_;
};
template <class S>
thread_local std::vector<S> Evaluation<S>::inputs_;
template <class S>
thread_local std::vector<S> Evaluation<S>::values_;

class InterpretedJoint final : public JointType {
 public:
  explicit InterpretedJoint(const TracedJoint& joint) : joint_(joint), constant_count_(constantCount(joint)) {
    if (joint_.space) rates_ = ratesOf(joint_);
    kinematics_ = kinematicsOf(joint_, rates_);
    for (const TracedParameter& p : joint_.parameters) examples_.push_back(exampleOf(p));
    for (std::size_t k = 0; k < joint_.parameters.size(); ++k) {
      const TracedParameter& p = joint_.parameters[k];
      const ParameterKind kind = p.size == 1 ? ParameterKind::number : p.size == 3 ? ParameterKind::vector3 : ParameterKind::numbers;
      specs_.push_back({p.name.c_str(), kind, p.usual.empty(), p.unit.c_str(), p.help.c_str(), examples_[k].c_str()});
    }
    info_ = {joint_.name.c_str(), joint_.summary.c_str(),         Structure::joint, joint_.space ? closed_configuration | own_rates : 0u,
             specs_.data(),       static_cast<int>(specs_.size())};
  }

  const JointTypeInfo& info() const noexcept override { return info_; }

  bool prepare(const ParameterArgument* a, JointInstance& out, char* message, int size) const noexcept override {
    for (std::size_t k = 0; k < joint_.parameters.size(); ++k)
      if (a[k].given && a[k].count != joint_.parameters[k].size) {
        std::snprintf(message, static_cast<std::size_t>(size), "%s must have %d numbers", joint_.parameters[k].name.c_str(),
                      joint_.parameters[k].size);
        return false;
      }
    out.shape = Shape::dense;
    out.nq = joint_.nq;
    out.nv = joint_.nv;
    out.constant_count = constant_count_;
    return true;
  }
  void constants(const ParameterArgument* a, double* out) const noexcept override {
    for (std::size_t k = 0; k < joint_.parameters.size(); ++k) {
      const TracedParameter& p = joint_.parameters[k];
      out = std::copy_n(a[k].given ? a[k].numbers : p.usual.data(), p.size, out);
    }
  }

  void kinematics(const JointBatch<double>& b) const noexcept override { evaluate<double>(b); }
  void kinematics(const JointBatch<float>& b) const noexcept override { evaluate<double>(b); }
  void kinematics(const JointBatch<Dual<double>>& b) const noexcept override { evaluate<Dual<double>>(b); }
  void kinematics(const JointBatch<Dual<Dual<double>>>& b) const noexcept override { evaluate<Dual<Dual<double>>>(b); }
  bool kinematics(const JointBatch<Traced>& b) const noexcept override {
    evaluate<Traced>(b);
    return true;
  }

  void neutral(const ConfigurationBatch<double>& b) const noexcept override {
    each(b, [&](int i) {
      if (!joint_.space) return fill(b.q_out, b.q_stride, i, joint_.nq);
      store(apply(joint_.space->neutral, {constantsOf(b, i)}), b.q_out, b.q_stride, i);
    });
  }
  void integrate(const ConfigurationBatch<double>& b) const noexcept override {
    each(b, [&](int i) {
      const std::vector<double> q = load(b.q0, b.q_stride, i, joint_.nq), v = load(b.v, b.v_stride, i, joint_.nv), c = constantsOf(b, i);
      if (b.q_out) store(sum(q, v, c), b.q_out, b.q_stride, i);
      if (b.J_q) storeJacobians(dIntegrate(q, v, c), b, i);
    });
  }
  void difference(const ConfigurationBatch<double>& b) const noexcept override {
    each(b, [&](int i) {
      const std::vector<double> q0 = load(b.q0, b.q_stride, i, joint_.nq), q1 = load(b.q1, b.q_stride, i, joint_.nq), c = constantsOf(b, i);
      const std::vector<double> d = way(q0, q1, c);
      if (b.v_out) store(d, b.v_out, b.v_stride, i);
      if (!b.J_q) return;
      // q1 = q0 (+) d: Jv dd = dq1 - Jq dq0.
      const Jacobians J = dIntegrate(q0, d, c);
      const auto solver = J.by_v.colPivHouseholderQr();
      storeJacobians({-solver.solve(J.by_q), solver.solve(Eigen::MatrixXd::Identity(joint_.nv, joint_.nv))}, b, i);
    });
  }
  void normalize(const ConfigurationBatch<double>& b) const noexcept override {
    each(b, [&](int i) {
      const std::vector<double> q = load(b.q0, b.q_stride, i, joint_.nq);
      const std::vector<double> n = joint_.space ? apply(joint_.space->normalize, {q, constantsOf(b, i)}) : q;
      double distance = 0;
      for (std::size_t k = 0; k < q.size(); ++k) distance = std::hypot(distance, n[k] - q[k]);
      if (b.q_out) store(n, b.q_out, b.q_stride, i);
      if (b.v_out) b.v_out[i] = distance;
    });
  }
  void rates(const ConfigurationBatch<Dual<double>>& b) const noexcept override { evaluateRates(b); }
  bool rates(const ConfigurationBatch<Traced>& b) const noexcept override {
    evaluateRates(b);
    return true;
  }

 private:
  struct Jacobians {
    Eigen::MatrixXd by_q, by_v;
  };

  /// Computes in S what the batch has in T.
  template <class S, class T>
  void evaluate(const JointBatch<T>& b) const {
    const int nq = joint_.nq, nv = joint_.nv;
    for (int i = 0; i < b.count * b.lanes; ++i) {
      Evaluation<S> e(kinematics_);
      for (int k = 0; k < nq; ++k) e.inputs()[k] = static_cast<S>(b.q[k * b.q_stride + i]);
      for (int k = 0; b.v && k < nv; ++k) e.inputs()[nq + k] = static_cast<S>(b.v[k * b.v_stride + i]);
      for (int k = 0; k < constant_count_; ++k) e.inputs()[nq + nv + k] = S(b.constants[k * b.constants_stride + i / b.lanes]);
      e.run();
      const auto write = [&](T* to, int first, int count) {
        for (int k = 0; k < count; ++k) to[k * b.stride + i] = static_cast<T>(e[first + k]);
      };
      write(b.pose, 0, 12);
      if (b.subspace) write(b.subspace, 12, 6 * nv);
      if (b.v && b.bias) write(b.bias, 12 + 6 * nv, 6);
    }
  }
  template <class S>
  void evaluateRates(const ConfigurationBatch<S>& b) const {
    if (!rates_) return;
    const int nq = joint_.nq, nv = joint_.nv;
    for (int i = 0; i < b.count * b.lanes; ++i) {
      Evaluation<S> e(*rates_);
      for (int k = 0; k < nq; ++k) e.inputs()[k] = b.q0[k * b.q_stride + i];
      for (int k = 0; k < nv; ++k) e.inputs()[nq + k] = b.v[k * b.v_stride + i];
      for (int k = 0; k < constant_count_; ++k) e.inputs()[nq + nv + k] = S(b.constants[k * b.constants_stride + i / b.lanes]);
      e.run();
      for (int k = 0; k < nq; ++k) b.q_out[k * b.q_stride + i] = e[k];
    }
  }

  template <class Each>
  static void each(const ConfigurationBatch<double>& b, const Each& one) {
    for (int i = 0; i < b.count * b.lanes; ++i) one(i);
  }
  static std::vector<double> load(const double* base, std::ptrdiff_t stride, int i, int count) {
    std::vector<double> out;
    for (int k = 0; k < count; ++k) out.push_back(base[k * stride + i]);
    return out;
  }
  static void store(const std::vector<double>& x, double* base, std::ptrdiff_t stride, int i) {
    for (std::size_t k = 0; k < x.size(); ++k) base[static_cast<std::ptrdiff_t>(k) * stride + i] = x[k];
  }
  static void fill(double* base, std::ptrdiff_t stride, int i, int count) {
    for (int k = 0; k < count; ++k) base[k * stride + i] = 0;
  }
  void storeJacobians(const Jacobians& J, const ConfigurationBatch<double>& b, int i) const {
    for (int k = 0; k < joint_.nv * joint_.nv; ++k) {
      b.J_q[k * b.j_stride + i] = J.by_q(k / joint_.nv, k % joint_.nv);
      b.J_v[k * b.j_stride + i] = J.by_v(k / joint_.nv, k % joint_.nv);
    }
  }
  std::vector<double> constantsOf(const ConfigurationBatch<double>& b, int i) const {
    return load(b.constants, b.constants_stride, i / b.lanes, constant_count_);
  }

  template <class S = double>
  static std::vector<S> apply(const Graph& graph, std::initializer_list<std::vector<S>> arguments) {
    std::vector<S> all;
    for (const std::vector<S>& a : arguments) all.insert(all.end(), a.begin(), a.end());
    return replay<S>(graph, all);
  }
  std::vector<double> sum(const std::vector<double>& q, const std::vector<double>& v, const std::vector<double>& c) const {
    if (joint_.space) return apply(joint_.space->integrate, {q, v, c});
    std::vector<double> out = q;
    for (std::size_t k = 0; k < v.size(); ++k) out[k] += v[k];
    return out;
  }
  std::vector<double> way(const std::vector<double>& q0, const std::vector<double>& q1, const std::vector<double>& c) const {
    if (joint_.space) return apply(joint_.space->difference, {q0, q1, c});
    std::vector<double> out = q1;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] -= q0[k];
    return out;
  }

  /// Changes of the coordinates of q (+) v, turned into velocities there by least squares.
  Jacobians dIntegrate(const std::vector<double>& q, const std::vector<double>& v, const std::vector<double>& c) const {
    const int nq = joint_.nq, nv = joint_.nv;
    const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(nv, nv);
    if (!joint_.space) return {one, one};
    const auto column = [&](const std::vector<double>& at, int k) {
      std::vector<double> unit(static_cast<std::size_t>(nv), 0.0);
      unit[static_cast<std::size_t>(k)] = 1;
      return apply(*rates_, {at, unit, c});
    };
    constexpr double beside_zero = 0x1p-250;
    const bool still = std::all_of(v.begin(), v.end(), [](double x) { return x == 0; });
    const std::vector<double> end = sum(q, v, c);
    Eigen::MatrixXd at_end(nq, nv), changes(nq, 2 * nv);
    for (int k = 0; k < nv; ++k) {
      const std::vector<double> dq = column(q, k), there = column(end, k);
      for (int which = 0; which < 2; ++which) {
        std::vector<Dual<double>> x, u, constants(c.begin(), c.end());
        for (int i = 0; i < nq; ++i) x.emplace_back(q[static_cast<std::size_t>(i)], which == 0 ? dq[static_cast<std::size_t>(i)] : 0.0);
        for (int i = 0; i < nv; ++i)
          u.emplace_back(still ? (i == k ? beside_zero : 0.0) : v[static_cast<std::size_t>(i)], which == 1 && i == k ? 1.0 : 0.0);
        const auto out = apply<Dual<double>>(joint_.space->integrate, {x, u, constants});
        for (int i = 0; i < nq; ++i) changes(i, which * nv + k) = out[static_cast<std::size_t>(i)].d;
      }
      for (int i = 0; i < nq; ++i) at_end(i, k) = there[static_cast<std::size_t>(i)];
    }
    const Eigen::MatrixXd J = at_end.colPivHouseholderQr().solve(changes);
    return {J.leftCols(nv), J.rightCols(nv)};
  }

  TracedJoint joint_;
  int constant_count_;
  std::optional<Graph> rates_;
  Graph kinematics_;
  std::vector<std::string> examples_;
  std::vector<ParameterSpec> specs_;
  JointTypeInfo info_{};
};

}  // namespace

const JointType& interpretJoint(const TracedJoint& joint) {
  checkJoint(joint);
  // Models keep pointers to their types, so types live for good.
  static std::mutex mutex;
  static std::deque<InterpretedJoint> types;
  const std::lock_guard lock(mutex);
  return types.emplace_back(joint);
}

}  // namespace dyn
