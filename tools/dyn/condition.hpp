// SPDX-License-Identifier: BSD-2-Clause
// A warning about the digits that a nearly singular mass matrix costs.
#pragma once

#include <dyn/dyn.hpp>

#include <string>

namespace dyn::tool {

/// Empty if accelerations and M^-1 keep four digits at q; otherwise a text with the condition number of M and the digits that are left.
std::string warningOfCondition(const CompactModel& model, const Eigen::VectorXd& q);

}  // namespace dyn::tool
