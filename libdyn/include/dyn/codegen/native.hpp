// Machine code for one model, made while the program runs: traced, written as C, compiled by the system's compiler, kept on disk, loaded.
#pragma once

#include <dyn/codegen/source.hpp>
#include <dyn/data/views.hpp>

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct NativeOptions {
  bool single_precision = false;
  int lanes = 1;  ///< states a call, as SourceOptions::lanes
  /// Folder of compiled functions; empty: $LIBDYN_CACHE, else $XDG_CACHE_HOME/libdyn, else ~/.cache/libdyn.
  std::string cache{};
  std::string compiler{};  ///< a program; empty: the words of $CC, else cc
  /// Beside those that the source needs. Tuned for some processors, gcc 12 keeps numbers in registers of integers, which takes longer.
  std::vector<std::string> flags = {"-O2", "-march=native", "-mtune=generic"};
  double seconds = 300;                              ///< after so long a compiler that is still running is ended
  std::size_t operations = 1000000;                  ///< a function of more is refused
  std::function<void(const std::string&)> progress;  ///< told what is done next
};

/// A compiled function. Cheap to copy; may be called from any thread; its code stays loaded as long as the process lives.
class DYN_API CompiledFunction {
 public:
  struct Impl;
  explicit CompiledFunction(std::shared_ptr<const Impl> impl);
  /// Moving copies, which is as cheap: none is ever empty.
  CompiledFunction(const CompiledFunction&) = default;
  CompiledFunction& operator=(const CompiledFunction&) = default;

  const std::string& name() const;
  const std::vector<ArgumentShape>& inputs() const;
  const std::vector<ArgumentShape>& outputs() const;
  /// Whether it came from the cache.
  bool cached() const;

  /// One state, in double. O(operations); no check of values. Throws Error(size) unless there are as many arguments of the sizes that inputs()
  /// and outputs() say, Error(argument) for functions of several states or in float.
  void operator()(std::initializer_list<VectorArg> in, std::initializer_list<VectorOut> out) const;
  /// The same without checks; `in` and `out` point to a pointer each for every argument, of double or float as it was compiled.
  void call(const void* const* in, void* const* out) const;

 private:
  std::shared_ptr<const Impl> impl_;
};

class DYN_API CompiledModel {
 public:
  explicit CompiledModel(std::vector<CompiledFunction> functions);
  const std::vector<CompiledFunction>& functions() const { return functions_; }
  /// Throws Error(argument) for a name that was not compiled.
  const CompiledFunction& function(const std::string& name) const;

 private:
  std::vector<CompiledFunction> functions_;
};

/// Functions by trace()'s names, or any that were traced. Two processes may compile the same at once. What lies in the cache is used if it was
/// made from the same source by the same compiler with the same flags for the same processor, belongs to this user, can be written by nobody else,
/// and is whole; else it is made anew. Throws what trace() throws; Error(compiler) if there is no compiler, it fails, or it takes too long;
/// Error(file) if the cache cannot be written.
DYN_API CompiledModel compileNative(const CompactModel& model, const std::vector<std::string>& functions, const NativeOptions& options = {});
DYN_API CompiledModel compileNative(const std::vector<TracedFunction>& functions, const NativeOptions& options = {});

}  // namespace dyn
