// Every algorithm on a model that nobody has looked at.
#pragma once

#include <dyn/dyn.hpp>

#include <cstdint>

namespace dyn::fuzz {

/// Calls them at a random state and at neutral. A finding: what contradicts itself, or what is not finite although the description's numbers and its
/// results on the way are far from where doubles end.
void exercise(const Model& description, const CompactModel& model, std::uint64_t seed);

}  // namespace dyn::fuzz
