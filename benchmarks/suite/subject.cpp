// SPDX-License-Identifier: BSD-2-Clause
#include "suite/suite.hpp"

#include <cstdlib>

namespace dyn::suite {

using ::benchmark::RegisterBenchmark;

Subject::Subject(CompactModel compact, int count) : model(std::move(compact)), q(model.nq(), count), v(model.nv(), count), a(model.nv(), count) {
  for (int k = 0; k < count; ++k) q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(k));
  v.setRandom();
  a.setRandom();
}

void report(::benchmark::State& state, const Subject& subject, double states_each) {
  const double states = static_cast<double>(state.iterations()) * states_each;
  using Counter = ::benchmark::Counter;
  state.counters["s_per_state"] = Counter(states, Counter::kIsRate | Counter::kInvert);
  state.counters["s_per_joint"] = Counter(states * subject.joints(), Counter::kIsRate | Counter::kInvert);
}

namespace {

template <class Run>
void add(const std::string& name, const SubjectPtr& subject, Need needs, Run run) {
  RegisterBenchmark(name.c_str(), [subject, needs, run](::benchmark::State& state) {
    Data data(subject->model, needs);
    Eigen::Index k = 0;
    for (auto _ : state) {
      run(subject->model, data, subject->q.col(k), subject->v.col(k), subject->a.col(k));
      k = (k + 1) % subject->q.cols();
    }
    report(state, *subject, 1);
  });
}

template <class T, class Run>
void addStates(const std::string& name, const SubjectPtr& subject, Need needs, Run run) {
  RegisterBenchmark(name.c_str(), [subject, needs, run](::benchmark::State& state) {
    using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
    const Matrix q = subject->q.cast<T>(), v = subject->v.cast<T>(), a = subject->a.cast<T>();
    BasicBatchData<T> batch(subject->model, static_cast<int>(q.cols()), needs);
    for (auto _ : state) run(subject->model, batch, q, v, a);
    report(state, *subject, static_cast<double>(q.cols()));
  });
}

template <class T>
void addBatchOf(const std::string& suffix, const SubjectPtr& s) {
  addStates<T>("fk/" + suffix, s, Need::kinematics, [](auto& m, auto& d, auto& q, auto&, auto&) { forwardKinematics(m, d, q); });
  addStates<T>("rnea/" + suffix, s, Need::state, [](auto& m, auto& d, auto& q, auto& v, auto& a) { rnea(m, d, q, v, a); });
  addStates<T>("aba/" + suffix, s, Need::state, [](auto& m, auto& d, auto& q, auto& v, auto& a) { aba(m, d, q, v, a); });
  addStates<T>("crba/" + suffix, s, Need::mass_matrix, [](auto& m, auto& d, auto& q, auto&, auto&) { crba(m, d, q); });
  addStates<T>("jacobians/" + suffix, s, Need::jacobians, [](auto& m, auto& d, auto& q, auto&, auto&) { computeJointJacobians(m, d, q); });
}

}  // namespace

void addSingle(const std::string& name, const SubjectPtr& s, bool quadratic) {
  const std::string suffix = name + "/single/double";
  add("fk/" + suffix, s, Need::state, [](auto& m, auto& d, const auto& q, const auto&, const auto&) { forwardKinematics(m, d, q); });
  add("rnea/" + suffix, s, Need::state, [](auto& m, auto& d, const auto& q, const auto& v, const auto& a) { rnea(m, d, q, v, a); });
  add("aba/" + suffix, s, Need::state, [](auto& m, auto& d, const auto& q, const auto& v, const auto& a) { aba(m, d, q, v, a); });
  add("jacobians/" + suffix, s, Need::state, [](auto& m, auto& d, const auto& q, const auto&, const auto&) { computeJointJacobians(m, d, q); });
  if (quadratic) add("crba/" + suffix, s, Need::mass_matrix, [](auto& m, auto& d, const auto& q, const auto&, const auto&) { crba(m, d, q); });
}

std::string sharedModels() {
  const char* shared = std::getenv("DYN_SHARED");
  return std::string(shared ? shared : DYN_SOURCE_DIR "/../shared") + "/models";
}

void addBatch(const std::string& name, const SubjectPtr& subject) {
  addBatchOf<double>(name + "/batch/double", subject);
  addBatchOf<float>(name + "/batch/float", subject);
}

}  // namespace dyn::suite
