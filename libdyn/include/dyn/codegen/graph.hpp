// Expression graphs: what a function does with its inputs, operation by operation, to be replayed on any scalar, differentiated, or written
// as source code.
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

struct GraphNode {
  Operation operation = Operation::constant;
  std::uint32_t argument[4] = {};  ///< nodes before this one; of an input its number
  double value = 0;                ///< of a constant
};

/// How many of each, for one evaluation.
struct OperationCounts {
  int additions = 0;  ///< and subtractions and negations
  int multiplications = 0;
  int divisions = 0;  ///< and square roots
  int functions = 0;  ///< sine and cosine of one angle count as one each
  int selections = 0;
  int total() const { return additions + multiplications + divisions + functions + selections; }
};

/// Nodes of one operation, from runs of the same code on other values (GraphBuilder::abreast), by run: what vectors may compute at once, each in a
/// lane of its own. Several at least are not no_node.
inline constexpr std::uint32_t no_node = 0xffffffff;
inline constexpr int most_abreast = 4;
using NodesAbreast = std::array<std::uint32_t, most_abreast>;

/// Arguments come before what uses them; every node leads to an output, and no two compute the same.
struct Graph {
  int inputs = 0;
  std::vector<GraphNode> nodes;
  std::vector<std::uint32_t> outputs;
  std::vector<NodesAbreast> abreast;  ///< no node is there twice. Nothing but a hint

  DYN_API OperationCounts count() const;
};

/// Nodes that a graph may have before it is given up: two million are 50 MB here, and more than compilers take in an hour.
inline constexpr std::size_t most_graph_nodes = std::size_t{1} << 21;

/// Makes a graph: each operation once, constants folded, products with 0, 1 and -1 and sums with 0 left out (numbers are taken to be finite),
/// signs moved to where they cost least.
class DYN_API GraphBuilder final : public Recorder {
 public:
  explicit GraphBuilder(std::size_t most_nodes = most_graph_nodes);
  ~GraphBuilder();
  GraphBuilder(const GraphBuilder&) = delete;
  GraphBuilder& operator=(const GraphBuilder&) = delete;

  /// The next input, a value that is not known.
  Traced input();
  Traced record(Operation operation, const Traced& a, const Traced& b, const Traced& c, const Traced& d) noexcept override;

  /// Runs of the same code on other values, one after the other: as many as most_abreast, each of which begins with run(k). Operations that come in
  /// the same place of a step are taken for the same; a step is what is recorded from step(number) on, in whichever order, and none before the first.
  /// Of numbers that a run knows nothing is recorded: what it has recorded less than another is where operations differ.
  void abreast(const std::function<void()>& runs);
  void run(int k);
  void step(int number);
  /// Numbers that the same code has found, of other values: may be computed abreast, and what they are made of, as far as none waits for another.
  void alike(const std::array<Traced, most_abreast>& numbers);
  bool inRun() const;
  /// A known number that no operation is simplified for.
  Traced opaque(double x);

  /// The graph of these results. What does not lead to one is left out. Throws Error(size) if there were more nodes than allowed: from then on
  /// nothing was recorded.
  Graph finish(std::span<const Traced> results) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The graph of f(in, out), run once on values that are not known. Throws what f throws, and as finish().
DYN_API Graph traceFunction(int inputs, int outputs, const std::function<void(const Traced* in, Traced* out)>& f);

// Replaying. S has the arithmetic operators, is made from double, and its namespace has sqrt, sin, cos, tan, exp, log, atan2, abs as far as the
// graph uses them. Scalars that record something themselves bring their own selectLess(a, b, x, y), a < b ? x : y: CppAD's CondExpLt, CasADi's
// if_else, ADOL-C's condassign.

/// All values of the graph; `values` has as many as nodes.
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

/// The function itself: in has graph.inputs numbers, the result one for each output.
template <class S>
std::vector<S> replay(const Graph& graph, std::span<const S> in) {
  std::vector<S> values(graph.nodes.size()), out;
  replayNodes(graph, in.data(), values.data());
  out.reserve(graph.outputs.size());
  for (const std::uint32_t o : graph.outputs) out.push_back(values[o]);
  return out;
}

}  // namespace dyn
