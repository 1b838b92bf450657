// SPDX-License-Identifier: BSD-2-Clause
// The measurements of `dyn bench`: one entry per line of its output.
#pragma once

#include "states.hpp"
#include "truth.hpp"

#include <dyn/codegen/native.hpp>
#include <dyn/dyn.hpp>

#include <report/quartiles.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyn::tool {

/// One line: the time that `round` takes for each of its `states`, and the errors at the states of the truth file.
struct Entry {
  std::string algorithm, scalar, mode;
  Need need = Need::state;  ///< of the Data that the entry uses
  std::size_t states = 0;
  std::function<void()> round;
  std::function<ErrorSummary()> error;
};

/// The default number of states.
constexpr int state_count = 256;

/// Owns everything that is measured. Data is made when the first entry uses it, with `needs`: the union of the needs of the chosen entries.
struct Subjects {
  Subjects(const CompactModel& m, const ConstraintSet& set, int in_a_batch = state_count)
      : model(m), batch_states(in_a_batch), states(randomStates(m, std::max(state_count, in_a_batch), 1)), constraint_set(set) {}
  const CompactModel& model;
  int batch_states;
  std::vector<State> states;
  ConstraintSet constraint_set;
  std::vector<TruthSample> truth;
  Need needs = Need::derivatives | Need::kinematics | Need::jacobians;  ///< everything, unless the caller narrows it

  Data& data() {
    if (!data_) data_.emplace(model, needs);
    return *data_;
  }
  ConstraintData& constraints() {
    if (!constraints_) constraints_.emplace(constraint_set, needs);
    return *constraints_;
  }

 private:
  std::optional<Data> data_;
  std::optional<ConstraintData> constraints_;
};

/// addSingle adds every algorithm, one state per call; addBatch those that take batches. T is double or float.
void addSingle(Subjects& x, std::vector<Entry>& entries);
template <class T>
void addBatch(Subjects& x, const char* scalar, int threads, std::vector<Entry>& entries);
extern template void addBatch<double>(Subjects&, const char*, int, std::vector<Entry>&);
extern template void addBatch<float>(Subjects&, const char*, int, std::vector<Entry>&);

/// [ns] Time per item of a round that processes `count` items: quartiles of eleven repetitions of about 2 ms each.
benchmark::Quartiles measure(const std::function<void()>& round, std::size_t count);

/// Adds functions of this model as generated code, with one state and with several states per call. Compiles them, or finds them in the cache.
void addGenerated(Subjects& x, const std::vector<std::string>& functions, std::vector<Entry>& entries);

/// [ns] Times of one state.
struct Pace {
  double generated, library;
};
/// Compares generated code with the library's own function, in batches if `lanes` is more than one or for floats. Returns none if the library has no
/// function that gives the same.
std::optional<Pace> paceOf(const CompactModel& model, const CompiledFunction& function, int lanes, bool single_precision);

}  // namespace dyn::tool
