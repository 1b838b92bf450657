// SPDX-License-Identifier: BSD-2-Clause
// The instruction set for which kernels and joint types are taken.
#pragma once

#include <string>

namespace dyn {

/// Returns "scalar", "baseline", "avx2" or "avx512", which also names the folders and files built for it. DYN_SIMD chooses it; if that is not set,
/// the best one is taken that this processor has and libdyn is built for. Throws Error(argument) if there is none, or not the one that was chosen.
const std::string& instructionSet();

}  // namespace dyn
