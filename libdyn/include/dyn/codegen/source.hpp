// SPDX-License-Identifier: BSD-2-Clause
// C source of traced functions. It is C99 and needs only <math.h>. Vectors, of states or of a graph's packable nodes, use the vector types of gcc
// and clang.
#pragma once

#include <dyn/codegen/trace.hpp>

#include <string>
#include <vector>

namespace dyn {

/// How source is written.
struct SourceOptions {
  bool single_precision = false;  ///< float instead of double
  /// States that one call computes side by side: 1, 2, 4, ... 64. With more than one, an argument x of n numbers is x[n][lanes].
  int lanes = 1;
  /// Most steps in one C function. A longer function is cut into pieces, for the compiler's sake. Short pieces need only short addresses, which keeps
  /// the code small enough for the caches.
  int piece = 1000;
  std::string prefix{};  ///< precedes the names of all functions
};

/// C source of functions, in three parts.
struct DYN_API Source {
  std::string types;         ///< definition of the number type dyn_real
  std::string declarations;  ///< declarations, each with a comment on the shapes of its arguments
  std::string definitions;   ///< function bodies and what they need
  std::vector<int> steps;    ///< by function: its operations; those that one vector does at once count as one

  /// Returns a header for programs that call the functions.
  std::string header() const;
  /// Returns the functions as a source that includes the header by this name, or as a source that stands alone.
  /// @{
  std::string code(const std::string& header_name) const;
  std::string code() const;
  /// @}
};

/// Writes each function as void PREFIXname(const double* q, const double* v, ..., double* tau, ...): inputs, then outputs, in the order of the
/// function's arguments. Deterministic. Throws Error(argument) for names that C does not allow, that occur twice or that the code uses itself, for
/// other lanes than above, and for a piece below 1.
DYN_API Source writeSource(const std::vector<TracedFunction>& functions, const SourceOptions& options = {});

}  // namespace dyn
