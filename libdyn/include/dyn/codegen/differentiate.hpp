// Derivatives of graphs, as graphs.
#pragma once

#include <dyn/codegen/graph.hpp>

namespace dyn {

/// The entries of a Jacobian that are not zero whatever the inputs, row after row, each with its column.
struct Sparsity {
  int rows = 0, columns = 0;
  std::vector<int> row, column;
};

struct JacobianGraph {
  Graph graph;  ///< of the same inputs; its outputs are the entries
  Sparsity sparsity;
};

/// d outputs / d inputs, by carrying the changes along all inputs forward, or the share in each output backward (Griewank and Walther 2008,
/// ch. 3). Forward pays for few inputs, reverse for few outputs. Selections are differentiated as if they stayed as they are; |x| has the
/// derivative 1 at 0.
enum class Mode { forward, reverse };
DYN_API JacobianGraph differentiate(const Graph& graph, Mode mode = Mode::forward);

/// d(weights . outputs) / d inputs: inputs are those of the graph, then a weight for each output; outputs one for each input of the graph.
DYN_API Graph gradient(const Graph& graph);

/// The change of the outputs along a direction: inputs are those of the graph, then their direction.
DYN_API Graph directional(const Graph& graph);

}  // namespace dyn
