// What a mass matrix that is nearly singular does to results, said in words.
#pragma once

#include <dyn/dyn.hpp>

#include <string>

namespace dyn::tool {

/// Empty while accelerations and M^-1 keep four digits at q; else the condition of M and the digits that are left.
std::string warningOfCondition(const CompactModel& model, const Eigen::VectorXd& q);

}  // namespace dyn::tool
