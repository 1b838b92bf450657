// SPDX-License-Identifier: BSD-2-Clause
// The version of the library that a program runs with.
#pragma once

#include <dyn/export.hpp>

#include <string>

namespace dyn {

struct Version {
  std::string number;           ///< of libdyn, such as "0.1.0"
  std::string build_type;       ///< CMake's, such as "Release"
  std::string instruction_set;  ///< of the kernels in use, such as "avx2"
  unsigned plugin_interface;    ///< plugins must have been built for this number: DYN_PLUGIN_ABI_VERSION
};

/// Returns the version of the library in use. Throws Error(argument) if DYN_SIMD names an unknown instruction set, or one that this processor lacks.
DYN_API Version version();

}  // namespace dyn
