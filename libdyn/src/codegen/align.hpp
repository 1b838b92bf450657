// Runs of the same code of which one has recorded less than another.
#pragma once

#include <dyn/codegen/graph.hpp>

#include <cstdint>
#include <vector>

namespace dyn {

/// What a run has recorded, nodes or no_node, in the places of what a longer one has, others free. Of numbers that a run knows beforehand nothing
/// is recorded: the places are chosen such that most nodes are beside those of their operation. Where the product of the lengths is beyond 2^22, and
/// that would take long, the free places come last.
std::vector<std::uint32_t> aligned(const std::vector<GraphNode>& nodes, const std::vector<std::uint32_t>& shorter,
                                   const std::vector<std::uint32_t>& longer);

}  // namespace dyn
