// SPDX-License-Identifier: BSD-2-Clause
// Runs every algorithm on a random model.
#pragma once

#include <dyn/dyn.hpp>

#include <cstdint>

namespace dyn::fuzz {

/// Calls the algorithms at neutral and at a random state. Reports a finding if results contradict each other, or if a result is not finite although
/// the description's numbers and the intermediate results are far from overflow.
void exercise(const Model& description, const CompactModel& model, std::uint64_t seed);

}  // namespace dyn::fuzz
