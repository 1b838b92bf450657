// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of graphs, as graphs.
#pragma once

#include <dyn/codegen/graph.hpp>

namespace dyn {

/// The entries of a Jacobian that can be nonzero. They come row after row in a JacobianGraph, and column after column in JacobianBlocks.
struct Sparsity {
  int rows = 0,          ///< rows of the matrix
      columns = 0;       ///< columns of the matrix
  std::vector<int> row,  ///< row of each entry, from 0
      column;            ///< column of each entry, from 0
};

/// The Jacobian of a graph, as a graph.
struct JacobianGraph {
  Graph graph;        ///< has the same inputs as the function; its outputs are the entries
  Sparsity sparsity;  ///< outputs x inputs, the places of the entries
};

/// The order in which differentiate() applies the chain rule (Griewank and Walther 2008, ch. 3).
enum class Mode {
  forward,  ///< propagates changes along all inputs through the graph; suits few inputs
  reverse   ///< propagates the sensitivities of each output backward; suits few outputs
};
/// Returns the graph of d outputs / d inputs. A selection has the derivative of the value that it takes. |x| has the derivative 1 at 0. Throws
/// Error(size) if the result has more than most_graph_nodes nodes.
DYN_API JacobianGraph differentiate(const Graph& graph, Mode mode = Mode::forward);

/// Returns the graph of d(weights . outputs) / d inputs. Its inputs are those of `graph`, then one weight per output. It has one output per input
/// of `graph`. Throws as differentiate().
DYN_API Graph gradient(const Graph& graph);

/// Returns the graph of the outputs' change along a direction. Its inputs are those of `graph`, then their direction. Throws as differentiate().
DYN_API Graph directional(const Graph& graph);

}  // namespace dyn
