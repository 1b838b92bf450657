// SPDX-License-Identifier: BSD-2-Clause
// A small library written as libraries with a static variant usually are, without libdyn's compiler.
#pragma once

#include <dispatch/contender.hpp>

namespace dyn::benchmark {

/// fk, rnea, crba and aba (dispatch "variant_library"): one variant visit a joint and pass, axes as the model gives them, sines and cosines
/// joint by joint, velocities and inertias in each body's frame. The tree is the compiled one (fixed joints merged, depth-first order), which
/// other libraries' readers also produce.
/// Throws Error(argument) for models with couplings or joints other than revolute, continuous, prismatic, spherical and free flyers.
Contest patternContest(const CompactModel& model);

}  // namespace dyn::benchmark
