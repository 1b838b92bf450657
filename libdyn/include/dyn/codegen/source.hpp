// C source of traced functions: C99, nothing but <math.h>; vectors of states, or of what a graph has abreast, by gcc's and clang's vector types.
#pragma once

#include <dyn/codegen/trace.hpp>

#include <string>
#include <vector>

namespace dyn {

struct SourceOptions {
  bool single_precision = false;  ///< float for double
  /// States a call computes side by side: 1, or a power of two. With more than one, argument x of n numbers is x[n][lanes].
  int lanes = 1;
  /// Steps a function at most; longer ones are cut into pieces, for the compiler's sake. Short ones have short addresses, of which code is made that
  /// fits the caches.
  int piece = 1000;
  std::string prefix{};  ///< of all names
};

struct DYN_API Source {
  std::string types;         ///< the number type
  std::string declarations;  ///< with the shapes of all arguments in words
  std::string definitions;
  std::vector<int> steps;  ///< by function: its operations, of which those that a vector does at once count as one

  /// For programs that call the functions.
  std::string header() const;
  /// The functions, in a source that includes that header by this name, or in one that stands alone.
  std::string code(const std::string& header_name) const;
  std::string code() const;
};

/// void PREFIXname(const double* q, const double* v, ..., double* tau, ...): inputs, then outputs, in the order of the function's arguments.
/// Deterministic. Throws Error(argument) for names that C does not allow, that are there twice, or that the code has for itself, and for lanes that
/// are no power of two.
DYN_API Source writeSource(const std::vector<TracedFunction>& functions, const SourceOptions& options = {});

}  // namespace dyn
