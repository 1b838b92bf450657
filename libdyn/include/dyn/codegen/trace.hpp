// SPDX-License-Identifier: BSD-2-Clause
// The algorithms of one model as expression graphs.
#pragma once

#include <dyn/codegen/graph.hpp>
#include <dyn/compile/compact_model.hpp>

#include <string>
#include <vector>

namespace dyn {

/// Name and shape of an argument: a vector, or a matrix that is stored column after column.
struct ArgumentShape {
  std::string name;  ///< symbol, such as q
  int rows = 0,      ///< length of a vector
      columns = 1;   ///< 1 for a vector
  /// Returns the number of entries.
  int size() const { return rows * columns; }
};

/// A graph whose inputs and outputs are split into arguments.
struct TracedFunction {
  std::string name;                   ///< name of the function
  Graph graph;                        ///< inputs and outputs argument after argument
  std::vector<ArgumentShape> inputs,  ///< shapes of the inputs, in order
      outputs;                        ///< shapes of the outputs, in order
};

/// Returns the names that trace() accepts: rnea, nonLinearEffects, gravity, crba, aba, minverse, forwardKinematics, frames, jacobians,
/// rnea_derivatives, aba_derivatives, centroidal_map.
DYN_API const std::vector<std::string>& traceableFunctions();

/// How algorithms are traced.
struct TraceOptions {
  /// Declares operations packable (Graph::packable): those of limbs that are alike, and in matrices also those of neighbouring degrees of
  /// freedom. Use it for source of one state per call. The source is shorter then, though it has more operations: zeros and ones among the model's
  /// numbers simplify an operation only where all lanes have them.
  bool packable = false;
};

/// Runs an algorithm on unknown values and returns what it computes. Results are those of the function of the same name (minverse is computeMinverse,
/// gravity generalizedGravity), but without its checks: zero quaternions and zero pivots give NaN or infinity here. Poses of joints and frames have
/// 12 numbers per column: the rotation row after row, then the position. Throws Error(argument) for an unknown name, Error(model) for a model with
/// dependent joints, Error(joint_type), which names the type and a remedy, for a type whose plugin cannot be traced, and Error(size) for more than
/// most_graph_nodes operations.
DYN_API TracedFunction trace(const CompactModel& model, const std::string& function, const TraceOptions& options = {});

}  // namespace dyn
