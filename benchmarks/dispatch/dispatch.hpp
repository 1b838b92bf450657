// SPDX-License-Identifier: BSD-2-Clause
// The four algorithms for one model, each with four ways of dispatch.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// Makes the contenders of a model. If the model has joint types that are not in the closed set, the ways that need this set are missing.
/// Throws Error(argument) for a model with couplings.
Contest dispatchContest(const CompactModel& model);

}  // namespace dyn::benchmark
