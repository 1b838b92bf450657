// SPDX-License-Identifier: BSD-2-Clause
// Alignment of two runs of the same code that recorded different numbers of operations.
#pragma once

#include <dyn/codegen/graph.hpp>

#include <cstdint>
#include <vector>

namespace dyn {

/// Spreads the nodes of the shorter run, in order, over the places of the longer one; the places left over are no_node. A run that knows some values
/// as constants records fewer operations, so the places are chosen such that as many nodes as possible stand opposite a node of the same operation.
/// If the product of the lengths exceeds 2^22, that would take long, and the free places come last instead.
std::vector<std::uint32_t> aligned(const std::vector<GraphNode>& nodes, const std::vector<std::uint32_t>& shorter,
                                   const std::vector<std::uint32_t>& longer);

}  // namespace dyn
