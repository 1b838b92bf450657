// What the benchmarks share: models, random states, and names such as "rnea/talos/single/double".
#pragma once

#include <dyn/dyn.hpp>

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

namespace dyn::suite {

/// A model with as many random states as keep branch predictors honest.
struct Subject {
  explicit Subject(CompactModel compact, int count = 64);
  CompactModel model;
  Eigen::MatrixXd q, v, a;  ///< columns are states
  int joints() const { return model.njoints() - 1; }
};
using SubjectPtr = std::shared_ptr<const Subject>;

/// Counts a state a time: ns a state, and ns a joint.
void report(::benchmark::State& state, const Subject& subject, double states_each);

/// fk, rnea, crba, aba and Jacobians of one state after the other; without `quadratic` those of O(n) alone.
void addSingle(const std::string& name, const SubjectPtr& subject, bool quadratic);
/// The same of 256 states at once, in double and float.
void addBatch(const std::string& name, const SubjectPtr& subject);

/// The folder of test robots beside the project, $DYN_SHARED/models; it may be absent.
std::string sharedModels();

// One file each.
void addRobots();
void addShapes();
void addPluginJoint();

}  // namespace dyn::suite
