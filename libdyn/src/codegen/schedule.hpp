// SPDX-License-Identifier: BSD-2-Clause
// The order in which a graph's operations are computed: one by one, or several at once in the lanes of a vector.
#pragma once

#include <dyn/codegen/graph.hpp>

#include <cstdint>
#include <vector>

namespace dyn {

/// One step of the schedule: a single node, or several nodes of one operation that a vector computes at once.
struct Unit {
  PackableNodes nodes;  ///< by lane; a single node is in the first
  bool several = false;
  Operation operation = Operation::constant;
};

/// Where a node's value is computed.
struct Place {
  int unit = -1;  ///< -1: none; inputs, constants, and sines and cosines of inputs are available from the start
  int lane = 0;
};

struct Schedule {
  std::vector<GraphNode> nodes;  ///< the graph's; the two factors or summands of a node may be swapped
  std::vector<Unit> units;       ///< in order of computation
  std::vector<Place> places;     ///< by node
};

/// Whether the node is a sine or cosine of an input.
bool isTurn(const std::vector<GraphNode>& nodes, std::uint32_t node);

/// Returns the k-th arguments of a unit's nodes, by lane.
PackableNodes argumentsOf(const std::vector<GraphNode>& nodes, const Unit& unit, int k);

/// Orders the graph's operations. With `packable`, vectors compute several at once where that outweighs moving numbers into and out of lanes.
Schedule schedule(const Graph& graph, bool packable);

}  // namespace dyn
