// SPDX-License-Identifier: BSD-2-Clause
// The entries of `dyn bench`: calls of each algorithm, for single states and for batches.
#include "bench.hpp"

#include <chrono>
#include <memory>
#include <optional>
#include <utility>

namespace dyn::tool {

namespace {

/// The numbers of a result, column after column.
template <class Result>
Eigen::VectorXd numbersOf(const Result& result) {
  return result.template cast<double>().reshaped();
}

/// Returns the numbers of the results that have a key, one after the other; resultOf(k) has those of output k.
template <class ResultOf>
Eigen::VectorXd keyedNumbers(const AlgorithmInfo& algorithm, ResultOf&& resultOf) {
  Eigen::VectorXd out;
  for (std::size_t k = 0; k < algorithm.outputs.size(); ++k) {
    if (algorithm.outputs[k].key == nullptr) continue;
    const Eigen::VectorXd numbers = resultOf(k);
    out.conservativeResize(out.size() + numbers.size());
    out.tail(numbers.size()) = numbers;
  }
  return out;
}

/// The results of an algorithm of the catalogue, for one state.
struct Numbered {
  AlgorithmResults results;
  const AlgorithmInfo& algorithm;
};
Eigen::VectorXd numbersOf(const Numbered& x) {
  return keyedNumbers(x.algorithm, [&](std::size_t k) { return Eigen::VectorXd(x.results(k).reshaped()); });
}

/// The results of many states.
template <class T>
struct NumberedStates {
  detail::BatchViews<T> results;
  const AlgorithmInfo& algorithm;

  Eigen::VectorXd col(Eigen::Index state) const {
    return keyedNumbers(algorithm, [&](std::size_t k) { return Eigen::VectorXd(results(k).col(state).template cast<double>()); });
  }
};
// Clang deduces the arguments of aggregates from version 17 on only.
template <class T>
NumberedStates(detail::BatchViews<T>, const AlgorithmInfo&) -> NumberedStates<T>;

/// Calls f at the state, and once more for each direction of q (in its tangent space), of v and of tau, moved by 1e-8.
template <class Function>
void differences(const CompactModel& model, const State& s, Eigen::VectorXd& step, Function&& f) {
  static thread_local Eigen::VectorXd q, v, a;
  q = s.q;
  v = s.v;
  a = s.tau;
  constexpr double h = 1e-8;
  f(q, v, a);
  step.setZero(model.nv());
  for (Eigen::Index k = 0; k < model.nv(); ++k) {
    step[k] = h;
    integrate(model, s.q, step, q);
    step[k] = 0;
    f(q, v, a);
  }
  q = s.q;
  for (Eigen::VectorXd* x : {&v, &a})
    for (Eigen::Index k = 0; k < model.nv(); ++k) {
      const double kept = (*x)[k];
      (*x)[k] += h;
      f(q, v, a);
      (*x)[k] = kept;
    }
}

template <class T>
using Columns = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

/// States as columns, and the batch that computes their results.
template <class T>
struct BatchSubject {
  Columns<T> q, v, a, tau;

  BatchSubject(const CompactModel& model, int states, int threads)
      : q(model.nq(), states), v(model.nv(), states), a(v), tau(v), model_(model), threads_(threads) {}
  /// The batch is made at the first call.
  BasicBatchData<T>& batch(Need needs) {
    if (!batch_) batch_.emplace(model_, static_cast<int>(q.cols()), needs, threads_);
    return *batch_;
  }
  void set(Eigen::Index k, const State& s) {
    q.col(k) = s.q.template cast<T>();
    v.col(k) = s.v.template cast<T>();
    a.col(k) = s.a.template cast<T>();
    tau.col(k) = s.tau.template cast<T>();
  }

 private:
  const CompactModel& model_;
  int threads_;
  std::optional<BasicBatchData<T>> batch_;
};

constexpr Need derivatives = Need::derivatives, mass_matrix = Need::mass_matrix;

}  // namespace

benchmark::Quartiles measure(const std::function<void()>& round, std::size_t count) {
  using Clock = std::chrono::steady_clock;
  constexpr int repetitions = 11;
  int rounds = 1;
  std::vector<double> times;
  for (int repetition = -1; repetition < repetitions; ++repetition) {
    const auto start = Clock::now();
    for (int i = 0; i < rounds; ++i) round();
    const double ns = std::chrono::duration<double, std::nano>(Clock::now() - start).count();
    if (repetition < 0) {
      rounds = benchmark::roundsInSample(ns);
      continue;
    }
    times.push_back(ns / (rounds * static_cast<double>(count)));
  }
  return benchmark::quartiles(times);
}

void addSingle(Subjects& x, std::vector<Entry>& entries) {
  // With dependent joints aba uses M.
  const Need of_aba = x.model.follows() ? mass_matrix : Need::state;
  const auto add = [&](const char* name, Need need, auto run) {
    Entry entry{name, "double", "single", need, x.states.size(), {}, {}};
    entry.round = [&x, run] {
      for (const State& s : x.states) run(x.model, x.data(), s);
    };
    if constexpr (!std::is_void_v<decltype(run(x.model, x.data(), x.states[0]))>)
      entry.error = [&x, run, name] {
        ErrorSummary errors;
        for (const TruthSample& sample : x.truth) addErrors(sample, name, numbersOf(run(x.model, x.data(), sample.state)), 0x1p-53, errors);
        return errors;
      };
    entries.push_back(std::move(entry));
  };
  for (const AlgorithmInfo& algorithm : algorithms())
    if (algorithm.name != nullptr)
      add(algorithm.name, algorithm.algorithm == Algorithm::aba ? of_aba : algorithm.need,
          [&algorithm, forward = algorithm.reads('t')](auto& m, auto& d, auto& s) {
            return Numbered{runAlgorithm(m, d, algorithm.algorithm, s.q, s.v, forward ? s.tau : s.a), algorithm};
          });
  // One-sided differences, for comparison with the derivatives: one call per direction, and one more.
  const auto step = std::make_shared<Eigen::VectorXd>();
  add("rnea_finite_differences", Need::state,
      [step](auto& m, auto& d, auto& s) { differences(m, s, *step, [&](auto& q, auto& v, auto& a) { rnea(m, d, q, v, a); }); });
  add("aba_finite_differences", of_aba,
      [step](auto& m, auto& d, auto& s) { differences(m, s, *step, [&](auto& q, auto& v, auto& a) { aba(m, d, q, v, a); }); });
  // The result has n^3 numbers, so larger models are skipped.
  if (x.model.nv() <= 100) {
    const auto second = std::make_shared<std::optional<SecondDerivativeData>>();
    add("rnea_second_derivatives", derivatives, [second](auto& m, auto& d, auto& s) {
      if (!*second) second->emplace(m);
      computeRNEASecondOrderDerivatives(m, d, **second, s.q, s.v, s.a);
    });
  }
  add("cholesky_decompose", derivatives, [](auto& m, auto& d, auto&) { cholesky::decompose(m, d); });
  add("cholesky_solve", derivatives, [step](auto& m, auto& d, auto& s) {
    *step = s.tau;
    cholesky::solve(m, d, *step);
  });
  add("forward_dynamics_cholesky", derivatives, [](auto& m, auto& d, auto& s) { return forwardDynamics(m, d, s.q, s.v, s.tau); });
  add("kinematics_derivatives", derivatives, [](auto& m, auto& d, auto& s) { computeForwardKinematicsDerivatives(m, d, s.q, s.v, s.a); });
  add("torque_regressor", derivatives, [](auto& m, auto& d, auto& s) { computeJointTorqueRegressor(m, d, s.q, s.v, s.a); });
  add("constraint_dynamics", derivatives, [&x](auto& m, auto& d, auto& s) { constraintDynamics(m, d, s.q, s.v, s.tau, x.constraints()); });
  add("constraint_dynamics_kkt", derivatives,
      [&x](auto& m, auto& d, auto& s) { constraintDynamics(m, d, s.q, s.v, s.tau, x.constraints(), ConstraintMethod::kkt); });
  add("constraint_dynamics_derivatives", derivatives,
      [&x](auto& m, auto& d, auto& s) { computeConstraintDynamicsDerivatives(m, d, s.q, s.v, s.tau, x.constraints()); });
  add("impulse", derivatives, [&x](auto& m, auto& d, auto& s) { impulseDynamics(m, d, s.q, s.v, 0.0, x.constraints()); });
  // Steps per second are 1e9 divided by these times. The steps are so short that the state hardly changes.
  for (const IntegratorInfo& info : integrators()) {
    if (info.adaptive || (info.implicit && x.model.nv() > 100)) continue;
    if (info.integrator == Integrator::variational && x.model.follows()) continue;
    const auto simulator = std::make_shared<std::optional<Simulator>>();
    add(("step_" + std::string(info.name)).c_str(), Need::state, [simulator, &x, integrator = info.integrator](auto&, auto&, auto&) {
      if (!*simulator) {
        simulator->emplace(ConstraintSet(x.model, {}), SimulatorOptions{.integrator = integrator, .dt = 1e-9});
        (*simulator)->reset(x.states[0].q, x.states[0].v);
      }
      (*simulator)->step();
    });
  }
  add("make_data", Need::state, [](auto& m, auto&, auto&) { const Data made(m); });
}

template <class T>
void addBatch(Subjects& x, const char* scalar, int threads, std::vector<Entry>& entries) {
  const auto subject = std::make_shared<BatchSubject<T>>(x.model, x.batch_states, threads);
  for (int k = 0; k < x.batch_states; ++k) subject->set(k, x.states[static_cast<std::size_t>(k)]);
  const auto add = [&](const char* name, Need need, auto run) {
    Entry entry{name,
                scalar,
                "batch",
                need,
                static_cast<std::size_t>(x.batch_states),
                [&x, subject, run] { run(x.model, *subject, subject->batch(x.needs)); },
                {}};
    if constexpr (!std::is_void_v<decltype(run(x.model, *subject, subject->batch(x.needs)))>)
      entry.error = [&x, run, name, threads] {
        const auto n = static_cast<int>(x.truth.size());
        if (n == 0) return ErrorSummary();
        BatchSubject<T> few(x.model, n, threads);
        BatchSubject<double> rounded(x.model, n, 1);
        for (int k = 0; k < n; ++k) few.set(k, x.truth[static_cast<std::size_t>(k)].state);
        rounded.q = few.q.template cast<double>();
        rounded.v = few.v.template cast<double>();
        rounded.a = few.a.template cast<double>();
        rounded.tau = few.tau.template cast<double>();
        const auto result = run(x.model, few, few.batch(x.needs));
        const auto in_double = run(x.model, rounded, rounded.batch(x.needs));
        ErrorSummary errors;
        for (int k = 0; k < n; ++k) {
          TruthSample sample = x.truth[static_cast<std::size_t>(k)];
          if constexpr (std::is_same_v<T, float>) replaceTruth(sample, name, in_double.col(k));
          addErrors(sample, name, numbersOf(result.col(k)), std::is_same_v<T, float> ? 0x1p-24 : 0x1p-53, errors);
        }
        return errors;
      };
    entries.push_back(std::move(entry));
  };
  for (const AlgorithmInfo& algorithm : algorithms())
    if (algorithm.name != nullptr && algorithm.batched)
      add(algorithm.name, algorithm.batch_need, [&algorithm, forward = algorithm.reads('t')](auto& m, auto& s, auto& d) {
        return NumberedStates{runAlgorithm(m, d, algorithm.algorithm, s.q, s.v, forward ? s.tau : s.a), algorithm};
      });
  if (x.model.follows()) return;
  add("cholesky_decompose", derivatives, [](auto& m, auto& s, auto& d) { cholesky::decompose(m, d, s.q); });
  const auto factored = std::make_shared<bool>(false);
  add("cholesky_solve", derivatives, [factored](auto& m, auto& s, auto& d) {
    if (!std::exchange(*factored, true)) cholesky::decompose(m, d, s.q);
    cholesky::solve(m, d, s.tau);
  });
}

template void addBatch<double>(Subjects&, const char*, int, std::vector<Entry>&);
template void addBatch<float>(Subjects&, const char*, int, std::vector<Entry>&);

}  // namespace dyn::tool
