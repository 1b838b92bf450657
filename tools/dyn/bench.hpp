// What `dyn bench` measures: one entry a line.
#pragma once

#include "states.hpp"
#include "truth.hpp"

#include <dyn/dyn.hpp>

#include <report/quartiles.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dyn::tool {

/// One line: how long `round` takes for each of the `states` that it goes through, and the errors at those of the truth.
struct Entry {
  std::string algorithm, scalar, mode;
  Need need = Need::state;  ///< of the data that it is given
  std::size_t states = 0;
  std::function<void()> round;
  std::function<ErrorSummary()> error;
};

/// Where nobody says how many.
constexpr int state_count = 256;

/// Everything that is measured lives here. Data is made when the first entry asks for it, with what those that are left need: `needs`.
struct Subjects {
  Subjects(const CompactModel& m, const ConstraintSet& set, int in_a_batch = state_count)
      : model(m), batch_states(in_a_batch), states(randomStates(m, std::max(state_count, in_a_batch), 1)), constraint_set(set) {}
  const CompactModel& model;
  int batch_states;
  std::vector<State> states;
  ConstraintSet constraint_set;
  std::vector<TruthSample> truth;
  Need needs = Need::derivatives | Need::kinematics | Need::jacobians;  ///< everything, unless somebody says less

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
