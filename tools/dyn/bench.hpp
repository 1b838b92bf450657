// What `dyn bench` measures: one entry a line.
#pragma once

#include "states.hpp"
#include "truth.hpp"

#include <dyn/dyn.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace dyn::tool {

/// One line: how long `round` takes for each of the states that it goes through, and the largest error at those of the truth.
struct Entry {
  std::string algorithm, scalar, mode;
  std::function<void()> round;
  std::function<double()> error;
};

constexpr int state_count = 256;

/// Of very large models derivatives are left out, and said to be: they take some twenty matrices of nv x nv.
inline Need needOf(const CompactModel& model) { return model.nv() <= 1000 ? Need::derivatives : Need::mass_matrix; }

/// Everything that is measured lives here.
struct Subjects {
  Subjects(const CompactModel& m, const ConstraintSet& set)
      : model(m), states(randomStates(m, state_count, 1)), data(m, needOf(m)), constraints(set, needOf(m)), truth() {}
  const CompactModel& model;
  std::vector<State> states;
  Data data;
  ConstraintData constraints;
  std::vector<TruthSample> truth;
};

/// The worst over samples; NaN if none has a truth.
inline double worst(double a, double b) { return std::isnan(a) ? b : (std::isnan(b) ? a : std::max(a, b)); }

/// Functions of this model as generated code, state by state and several states a call. Compiles them, or finds them in the cache.
void addGenerated(Subjects& x, const std::vector<std::string>& functions, std::vector<Entry>& entries);

}  // namespace dyn::tool
