// SPDX-License-Identifier: BSD-2-Clause
// Expression graphs: the operations of a function, one node each. A graph can be replayed on any scalar, differentiated, or written as source
// code.
#pragma once

#include <dyn/export.hpp>
#include <dyn/scalar/traced.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace dyn {

/// One operation of a graph.
struct GraphNode {
  Operation operation = Operation::constant;  ///< kind of the operation
  std::uint32_t argument[4] = {};             ///< earlier nodes; for an input, its number in argument[0]
  double value = 0;                           ///< for a constant, its value
};

/// The number of operations of each kind in one evaluation.
struct OperationCounts {
  int additions = 0;        ///< includes subtractions, negations and absolute values
  int multiplications = 0;  ///< products
  int divisions = 0;        ///< includes square roots
  int functions = 0;        ///< sine and cosine of one angle count as one each
  int selections = 0;       ///< operations select_less
  /// Returns the sum of all.
  int total() const { return additions + multiplications + divisions + functions + selections; }
};

inline constexpr std::uint32_t no_node = 0xffffffff;  ///< marks a lane without a node
inline constexpr int most_packable = 4;               ///< number of lanes of PackableNodes
/// Nodes of one operation that a vector may compute at once, one in each lane. They come from runs of the same code on different values
/// (GraphBuilder::packable), lane k from run k. At least two of them are not no_node.
using PackableNodes = std::array<std::uint32_t, most_packable>;

/// A function as a list of operations. Arguments come before the nodes that use them. Every node leads to an output, and no two nodes apply the same
/// operation to the same arguments.
struct Graph {
  int inputs = 0;                       ///< number of inputs; those that no output needs have no node
  std::vector<GraphNode> nodes;         ///< operations, inputs and constants, in an order of evaluation
  std::vector<std::uint32_t> outputs;   ///< node of each output
  std::vector<PackableNodes> packable;  ///< hints only; no node occurs twice

  /// Counts the operations of one evaluation. O(nodes).
  DYN_API OperationCounts count() const;
};

/// The number of nodes at which recording stops. Two million take 64 MiB here, and are more than compilers can process in an hour.
inline constexpr std::size_t most_graph_nodes = std::size_t{1} << 21;

/// Builds a graph. It records each operation once, folds constants, leaves out products with 0, 1 and -1 and sums with 0 (it assumes finite
/// numbers), and moves signs to where they cost least.
class DYN_API GraphBuilder final : public Recorder {
 public:
  /// Makes an empty graph. Recording stops after `most_nodes` nodes; later results are NaN, and finish() throws.
  explicit GraphBuilder(std::size_t most_nodes = most_graph_nodes);
  ~GraphBuilder();
  GraphBuilder(const GraphBuilder&) = delete;
  GraphBuilder& operator=(const GraphBuilder&) = delete;

  /// Adds the next input, an unknown value.
  Traced input();
  Traced record(Operation operation, const Traced& a, const Traced& b, const Traced& c, const Traced& d) noexcept override;

  /// Calls runs(), which runs the same code on different values, up to most_packable times in sequence. Each run begins with run(k). A step is what a
  /// run records after step(number); steps may come in any order. Operations at the same place of a step become packable. Nothing is compared
  /// before the first step, or after a negative number. A run that knows some values as constants records fewer operations; gaps are found where
  /// sequences differ.
  void packable(const std::function<void()>& runs);
  /// Begins run k outside any step. Throws Error(argument) unless k is at least 0 and below most_packable.
  void run(int k);
  /// Begins or resumes a step of the current run; a negative number ends the current step. Outside a run this does nothing.
  void step(int number);
  /// Declares values packable that the same code has computed from different values, and with them their arguments. Nodes that depend on each other
  /// are left out.
  void markPackable(const std::array<Traced, most_packable>& numbers);
  bool inRun() const;  ///< Returns true after run() until packable() returns.
  /// Returns a constant that is not used to simplify operations.
  Traced opaque(double x);

  /// Returns the graph of these results, without nodes that do not lead to one. Throws Error(size) if there were more nodes than allowed; recording
  /// stopped there.
  Graph finish(std::span<const Traced> results) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Returns the graph of f(in, out), which is run once on unknown values. `in` has `inputs` values and `out` has `outputs`. Throws what f throws, and
/// as finish().
DYN_API Graph traceFunction(int inputs, int outputs, const std::function<void(const Traced* in, Traced* out)>& f);

/// Computes the values of all nodes in scalars S. `in` has graph.inputs numbers, `values` has room for one per node. O(nodes).
/// S has the arithmetic operators and can be made from double. Its namespace has those of sqrt, sin, cos, tan, exp, log, atan2 and abs that the graph
/// uses. Scalars that record operations themselves provide their own selectLess(a, b, x, y), a < b ? x : y, for example by CppAD's CondExpLt,
/// CasADi's if_else or ADOL-C's condassign.
template <class S>
void replayNodes(const Graph& graph, const S* in, S* values) {
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const GraphNode& n = graph.nodes[i];
    if (n.operation == Operation::input) {
      values[i] = in[n.argument[0]];
    } else if (n.operation == Operation::constant) {
      values[i] = S(n.value);
    } else {
      values[i] = applied(n.operation, [&](int k) -> const S& { return values[n.argument[k]]; });
    }
  }
}

/// Evaluates the function in scalars S, which are as for replayNodes(). `in` has graph.inputs numbers, which is not checked; the result has one per
/// output. O(nodes). Allocates.
template <class S>
std::vector<S> replay(const Graph& graph, std::span<const S> in) {
  std::vector<S> values(graph.nodes.size()), out;
  replayNodes(graph, in.data(), values.data());
  out.reserve(graph.outputs.size());
  for (const std::uint32_t o : graph.outputs) out.push_back(values[o]);
  return out;
}

}  // namespace dyn
