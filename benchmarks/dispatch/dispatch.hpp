// The four algorithms, each reached in four ways, over one model.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// Of a model with types that only plugins have the ways of a closed set are missing. Throws Error(argument) for a model with couplings.
Contest dispatchContest(const CompactModel& model);

}  // namespace dyn::benchmark
