// Contacts as the command line names them.
#pragma once

#include <dyn/dyn.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// FRAME:6d (all of a frame is held) or FRAME:3d (a point of it). Throws CLI::ValidationError for anything else.
std::vector<ConstraintDescription> readContacts(const std::vector<std::string>& words);

/// Where a robot stands, for measurements of models that say nothing of contacts: the leaves of the tree that are lowest at the neutral
/// configuration, held as points, or as frames where there are no more than two.
std::vector<ConstraintDescription> lowestLeaves(const CompactModel& model);

}  // namespace dyn::tool
