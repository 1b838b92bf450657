// SPDX-License-Identifier: BSD-2-Clause
// Machine code for one model, made while the program runs. Functions are traced, written as C, compiled by the system's compiler, cached on disk
// and loaded.
#pragma once

#include <dyn/codegen/source.hpp>
#include <dyn/data/views.hpp>

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// How functions are compiled.
struct NativeOptions {
  bool single_precision = false;  ///< float instead of double
  int lanes = 1;                  ///< states per call, as SourceOptions::lanes
  /// Folder of compiled functions. Empty means $LIBDYN_CACHE, else $XDG_CACHE_HOME/libdyn, else ~/.cache/libdyn.
  std::string cache{};
  std::string compiler{};  ///< a program; empty means the words of $CC, else cc
  /// Added to the flags that the source needs. Tuning is generic because for some processors gcc 12 keeps numbers in integer registers, which is
  /// slower.
  std::vector<std::string> flags = {"-O2", "-march=native", "-mtune=generic"};
  double seconds = 300;                              ///< a compiler that runs longer for one function is stopped
  std::size_t operations = 1000000;                  ///< a function with more operations is refused
  std::function<void(const std::string&)> progress;  ///< called with a line that says what is done next
};

/// A compiled function. It is cheap to copy and may be called from any thread. Its code stays loaded until the process ends.
class DYN_API CompiledFunction {
 public:
  struct Impl;
  /// Used by compileNative().
  explicit CompiledFunction(std::shared_ptr<const Impl> impl);
  /// A move copies, which is as cheap, so no object is ever empty.
  CompiledFunction(const CompiledFunction&) = default;
  CompiledFunction& operator=(const CompiledFunction&) = default;

  /// Returns the name, or the shapes of the inputs or outputs for one state.
  /// @{
  const std::string& name() const;
  const std::vector<ArgumentShape>& inputs() const;
  const std::vector<ArgumentShape>& outputs() const;
  /// @}
  /// Returns true if the code came from the cache.
  bool cached() const;

  /// Evaluates one state in double. O(operations). Values are not checked. Throws Error(size) unless number and sizes of the arguments are those of
  /// inputs() and outputs(), at most 8 each. Throws Error(argument) for functions of several states or in float, and for null pointers.
  void operator()(std::initializer_list<VectorArg> in, std::initializer_list<VectorOut> out) const;
  /// The same without checks. `in` and `out` hold one pointer per argument, to double or float as the function was compiled.
  void call(const void* const* in, void* const* out) const;

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Compiled functions by name.
class DYN_API CompiledModel {
 public:
  /// Takes functions that are compiled already.
  explicit CompiledModel(std::vector<CompiledFunction> functions);
  /// Returns all functions, in the order in which they were asked for.
  const std::vector<CompiledFunction>& functions() const { return functions_; }
  /// Returns the function of this name. Throws Error(argument) for a name that was not compiled.
  const CompiledFunction& function(const std::string& name) const;

 private:
  std::vector<CompiledFunction> functions_;
};

/// Compiles functions, each by itself, given by trace()'s names or already traced. Two processes may compile the same function at once. A cached file
/// is used if it was made from the same source by the same compiler with the same flags for the same processor, belongs to this user, can be written
/// by nobody else, and is whole; otherwise it is made anew. Throws what trace() and writeSource() throw. Throws Error(compiler) if there is no
/// compiler, it fails or takes too long, or a function has too many operations. Throws Error(file) if the cache cannot be written, or others can
/// write it.
/// @{
DYN_API CompiledModel compileNative(const CompactModel& model, const std::vector<std::string>& functions, const NativeOptions& options = {});
DYN_API CompiledModel compileNative(const std::vector<TracedFunction>& functions, const NativeOptions& options = {});
/// @}

}  // namespace dyn
