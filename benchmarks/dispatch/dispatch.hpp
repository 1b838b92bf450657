// The four algorithms, each reached in four ways, over one model.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// Where a model has types that only plugins bring, the ways that need a closed set are missing. Throws Error(argument) for a model with couplings.
Contest dispatchContest(const CompactModel& model);

}  // namespace dyn::benchmark
