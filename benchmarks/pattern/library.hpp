// The whole pattern: a small library as those with a static variant are usually written, without libdyn's compiler.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// fk, rnea, crba and aba (dispatch "variant_library"): one visit a joint and pass, axes where the author put them, sines and cosines
/// joint by joint, velocities and inertias in each body's frame. Built from what the compiler left of the robot (welded bodies, depth-first
/// order), as other libraries' readers leave it.
/// Throws Error(argument) for models with couplings or joints other than revolute, continuous, prismatic, spherical and free flyers.
Contest patternContest(const CompactModel& model);

}  // namespace dyn::benchmark
