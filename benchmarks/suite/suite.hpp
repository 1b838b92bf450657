// SPDX-License-Identifier: BSD-2-Clause
// Shared by the benchmarks: models, random states, and names such as "rnea/talos/single/double".
#pragma once

#include <dyn/dyn.hpp>

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

namespace dyn::suite {

/// A model with random states, enough of them that the branch predictor does not learn them.
struct Subject {
  explicit Subject(CompactModel compact, int count = 64);
  CompactModel model;
  Eigen::MatrixXd q, v, a;  ///< columns are states
  int joints() const { return model.njoints() - 1; }
};
using SubjectPtr = std::shared_ptr<const Subject>;

/// Reports the time per state and per joint. `states_each` is the number of states in one iteration.
void report(::benchmark::State& state, const Subject& subject, double states_each);

/// Adds benchmarks of fk, rnea, crba, aba and Jacobians, one state after the other. Without `quadratic`, crba is left out.
void addSingle(const std::string& name, const SubjectPtr& subject, bool quadratic);
/// Adds the same benchmarks for all states of the subject at once, in double and float.
void addBatch(const std::string& name, const SubjectPtr& subject);

/// The folder with the shared test robots, $DYN_SHARED/models, by default beside the project. It may be absent.
std::string sharedModels();

// Each of these is in a file of its own.
void addRobots();
void addShapes();
void addPluginJoint();

}  // namespace dyn::suite
