// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of graphs, as graphs.
#pragma once

#include <dyn/codegen/graph.hpp>

namespace dyn {

/// The row and column of each entry of a Jacobian that can be nonzero, row after row.
struct Sparsity {
  int rows = 0, columns = 0;
  std::vector<int> row, column;
};

struct JacobianGraph {
  Graph graph;  ///< has the same inputs as the function; its outputs are the entries
  Sparsity sparsity;
};

/// Computes d outputs / d inputs. Forward mode carries changes along all inputs through the graph and suits few inputs; reverse mode carries the
/// sensitivities of each output backward and suits few outputs (Griewank and Walther 2008, ch. 3). A selection has the derivative of the value
/// that it takes. |x| has the derivative 1 at 0.
enum class Mode { forward, reverse };
DYN_API JacobianGraph differentiate(const Graph& graph, Mode mode = Mode::forward);

/// Returns the graph of d(weights . outputs) / d inputs. Its inputs are those of `graph`, then one weight per output. It has one output per input
/// of `graph`.
DYN_API Graph gradient(const Graph& graph);

/// Returns the graph of the outputs' change along a direction. Its inputs are those of `graph`, then their direction.
DYN_API Graph directional(const Graph& graph);

}  // namespace dyn
