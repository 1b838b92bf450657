// What `dyn bench` measures: one entry a line.
#pragma once

#include "states.hpp"
#include "truth.hpp"

#include <dyn/dyn.hpp>

#include <report/quartiles.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace dyn::tool {

/// One line: how long `round` takes for each of the `states` that it goes through, and the errors at those of the truth.
struct Entry {
  std::string algorithm, scalar, mode;
  std::size_t states = 0;
  std::function<void()> round;
  std::function<ErrorSummary()> error;
};

/// Where nobody says how many.
constexpr int state_count = 256;

/// Of very large models derivatives are left out, and said to be: they take some twenty matrices of nv x nv.
inline Need needOf(const CompactModel& model) { return model.nv() <= 1000 ? Need::derivatives : Need::mass_matrix; }

/// Everything that is measured lives here.
struct Subjects {
  Subjects(const CompactModel& m, const ConstraintSet& set, int in_a_batch = state_count)
      : model(m),
        batch_states(in_a_batch),
        states(randomStates(m, std::max(state_count, in_a_batch), 1)),
        data(m, needOf(m)),
        constraints(set, needOf(m)),
        truth() {}
  const CompactModel& model;
  int batch_states;
  std::vector<State> states;
  Data data;
  ConstraintData constraints;
  std::vector<TruthSample> truth;
};

/// Every algorithm, one state a call; and those that take batches, T being double or float.
void addSingle(Subjects& x, std::vector<Entry>& entries);
template <class T>
void addBatch(Subjects& x, const char* scalar, int threads, std::vector<Entry>& entries);
extern template void addBatch<double>(Subjects&, const char*, int, std::vector<Entry>&);
extern template void addBatch<float>(Subjects&, const char*, int, std::vector<Entry>&);

/// ns for each of the things, `count` of them, that a round goes through: quartiles of eleven repetitions of about 2 ms each.
benchmark::Quartiles measure(const std::function<void()>& round, std::size_t count);

/// Functions of this model as generated code, state by state and several states a call. Compiles them, or finds them in the cache.
void addGenerated(Subjects& x, const std::vector<std::string>& functions, std::vector<Entry>& entries);

}  // namespace dyn::tool
