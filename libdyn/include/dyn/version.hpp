// SPDX-License-Identifier: BSD-2-Clause
// The version of the library, and what it was built for.
#pragma once

#include <dyn/export.hpp>

#include <string>

namespace dyn {

/// The version of the library that a program runs with.
struct Version {
  std::string number;           ///< libdyn's version, such as "0.1.0"
  std::string build_type;       ///< CMake's build type, such as "Release"
  std::string instruction_set;  ///< the one of the kernels in use: "avx512", "avx2", "baseline" or "scalar"
  unsigned plugin_interface;    ///< plugins must have been built for this number: DYN_PLUGIN_ABI_VERSION
};

/// Returns the version of the library in use. Throws Error(argument) if DYN_SIMD names an unknown instruction set, or one that this processor or this
/// build of libdyn lacks.
DYN_API Version version();

}  // namespace dyn
