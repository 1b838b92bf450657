// SPDX-License-Identifier: BSD-2-Clause
// Runs every algorithm on a random model, and on its volumes.
#pragma once

#include <dyn/dyn.hpp>

#include <cstdint>

namespace dyn::fuzz {

/// Calls the algorithms at neutral and at a random state. Reports a finding if results contradict each other, or if a result is not finite although
/// the description's numbers and the intermediate results are far from overflow.
void exercise(const Model& description, const CompactModel& model, std::uint64_t seed);

/// Computes collisions and distances of the volumes at neutral, if there are at most 100 pairs. Volumes whose files are missing are left out.
void exerciseVolumes(const Model& description, const CompactModel& model);

}  // namespace dyn::fuzz
