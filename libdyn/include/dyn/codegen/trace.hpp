// The algorithms of one model as expression graphs.
#pragma once

#include <dyn/codegen/graph.hpp>
#include <dyn/compile/compact_model.hpp>

#include <string>
#include <vector>

namespace dyn {

/// A vector, or a matrix whose columns follow one another.
struct ArgumentShape {
  std::string name;
  int rows = 0, columns = 1;
  int size() const { return rows * columns; }
};

/// Inputs and outputs of the graph, split into arguments.
struct TracedFunction {
  std::string name;
  Graph graph;
  std::vector<ArgumentShape> inputs, outputs;
};

/// What trace() knows: rnea, nonLinearEffects, gravity, crba, aba, minverse, forwardKinematics, frames, jacobians, rnea_derivatives,
/// aba_derivatives, centroidal_map.
DYN_API const std::vector<std::string>& traceableFunctions();

struct TraceOptions {
  /// Limbs that are alike side by side, and neighbouring degrees of freedom where there are matrices: the graph says what vectors may compute at once
  /// (Graph::abreast). For source of one state a call: it is shorter then, though it has more operations, as zeros and ones among a model's
  /// numbers are made use of only where all that go side by side have them.
  bool abreast = false;
};

/// Runs an algorithm once on values that are not known. Results are those of the function of the same name (minverse is computeMinverse,
/// gravity generalizedGravity), but what that checks: quaternions and pivots of zero give NaN or infinity here. Joints' and frames' poses are 12
/// numbers a column: rotation, row after row, and position. Throws Error(argument) for a name that is not known, Error(model) for a model with joints
/// that follow others, Error(joint_type) for a type whose plugin cannot be traced, naming it and what to do, Error(size) for
/// more than most_graph_nodes operations.
DYN_API TracedFunction trace(const CompactModel& model, const std::string& function, const TraceOptions& options = {});

}  // namespace dyn
