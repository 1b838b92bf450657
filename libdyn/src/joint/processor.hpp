// Which instruction set kernels and joint types are taken for.
#pragma once

#include <string>

namespace dyn {

struct InstructionSet {
  std::string name;  ///< "scalar", "baseline", "avx2" or "avx512"; the last two name folders and files made for them
  bool forced;       ///< DYN_SIMD asks for it: what is not there is an error
};

/// What DYN_SIMD names, or else the best that this processor has. Throws Error(argument) for one that it has not.
const InstructionSet& instructionSet();

}  // namespace dyn
