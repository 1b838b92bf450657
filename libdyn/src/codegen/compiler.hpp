// SPDX-License-Identifier: BSD-2-Clause
// Compiles source by the system's compiler into shared objects that the cache keeps.
#pragma once

#include "codegen/cache.hpp"

#include <functional>
#include <string>
#include <vector>

namespace dyn {

/// One source and the command that compiles it.
struct CompilerTask {
  std::string what;                ///< what is compiled, for messages, such as "'rnea'"
  std::string size{};              ///< how large it is, such as " (1200 operations)", for a compiler that runs too long
  std::string prefix{};            ///< begins the entry's name in the cache
  std::string source;              ///< its text
  std::string file;                ///< the name of the source file, whose ending tells the language
  std::vector<std::string> words;  ///< the compiler
  std::vector<std::string> flags;  ///< its flags, without files
  std::string identity{};          ///< what else the object depends on: the text of headers
  double seconds = 300;            ///< a compiler that runs longer is stopped
  std::string remedy;              ///< what to do if it runs too long
};

/// Returns the compiler's command as words: `given`, else the words of the environment's variable, else `usual`.
std::vector<std::string> compilerCommand(const std::string& given, const char* variable, const char* usual);

/// Returns the name of the task's entry in the cache: a digest of all that the object depends on, the processor too. Throws Error(compiler) if the
/// compiler cannot be run.
std::string entryName(const CompilerTask& task);

/// Compiles, and enters the object into the cache by this name. Throws Error(compiler) with the compiler's output, and Error(file).
OpenFile compileInto(const ObjectCache& cache, const std::string& entry, const CompilerTask& task);

}  // namespace dyn
