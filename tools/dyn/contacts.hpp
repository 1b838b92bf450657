// SPDX-License-Identifier: BSD-2-Clause
// Contacts in the notation of the command line.
#pragma once

#include <dyn/dyn.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// Reads FRAME:6d (position and orientation of the frame are held) or FRAME:3d (its origin is held). Throws CLI::ValidationError for anything else.
std::vector<ConstraintDescription> readContacts(const std::vector<std::string>& words);

/// Default contacts for measurements: the leaves of the tree whose joints are lowest at the neutral configuration, to 1 % of the joints' height
/// range. One or two leaves are held as frames, more are held as points.
std::vector<ConstraintDescription> lowestLeaves(const CompactModel& model);

}  // namespace dyn::tool
