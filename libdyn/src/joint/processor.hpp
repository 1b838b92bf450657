// Which instruction set kernels and joint types are taken for.
#pragma once

#include <string>

namespace dyn {

/// "scalar", "baseline", "avx2" or "avx512", the name of folders and files made for it: what DYN_SIMD asks for, or else the best that this processor
/// has of those that libdyn is built for. Throws Error(argument) where there is none.
const std::string& instructionSet();

}  // namespace dyn
