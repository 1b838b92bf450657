// The four algorithms, each reached in four ways, over one model.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// Throws Error(argument) for a model with couplings, or with types that only plugins have: a closed set cannot hold them.
Contest dispatchContest(const CompactModel& model);

}  // namespace dyn::benchmark
