// In which order the operations of a graph are done: one by one, or some abreast in the lanes of a vector.
#pragma once

#include <dyn/codegen/graph.hpp>

#include <cstdint>
#include <vector>

namespace dyn {

/// What is done at once: a node, or several nodes of one operation.
struct Unit {
  NodesAbreast nodes;  ///< by lane; of a single one the first
  bool several = false;
  Operation operation = Operation::constant;
};

/// Where a node's value is.
struct Place {
  int unit = -1;  ///< none: an input, a constant, or a sine or cosine of an input, which are there from the start
  int lane = 0;
};

struct Schedule {
  std::vector<GraphNode> nodes;  ///< the graph's; factors and summands may have changed places
  std::vector<Unit> units;       ///< in their order
  std::vector<Place> places;     ///< by node
};

/// A sine or cosine of an input.
bool isTurn(const std::vector<GraphNode>& nodes, std::uint32_t node);

/// The k-th arguments of a unit's nodes, by lane.
NodesAbreast argumentsOf(const std::vector<GraphNode>& nodes, const Unit& unit, int k);

/// `abreast`: as far as that pays what it takes to bring numbers into lanes and out of them.
Schedule schedule(const Graph& graph, bool abreast);

}  // namespace dyn
