// SPDX-License-Identifier: BSD-2-Clause
// The library's only exception type. It says what was wrong, where, and how to repair it.
#pragma once

#include <dyn/export.hpp>

#include <stdexcept>
#include <string>

namespace dyn {

/// Kinds of failures.
enum class ErrorCode {
  argument,    ///< a value that an API call cannot use
  size,        ///< a vector or matrix of the wrong size
  file,        ///< a file that is missing, unreadable or too large
  syntax,      ///< a file or text whose content is malformed
  model,       ///< a description that is no valid mechanism
  joint_type,  ///< a joint or coupling type that no loaded plugin provides
  parameter,   ///< a joint parameter that is unknown, missing or ill-typed
  plugin,      ///< a shared object that cannot be loaded
  singular,    ///< a mass matrix that is singular at the given configuration
  compiler,    ///< a compiler that is missing, fails or takes too long
  closure,     ///< constraints that no configuration near the given one satisfies
  memory,      ///< more memory than the machine has
  simulation,  ///< a simulation that cannot go on: a state that is not finite, steps that collapse, a callback that throws
};

/// The place of an error. The message leaves out empty parts.
struct Where {
  std::string file;   ///< path of the file
  int line = 0;       ///< its line, from 1; 0: unknown
  std::string joint;  ///< name of the joint
};

/// Functions report every failure by throwing this. `what()` reads "file:line: joint 'j': message".
class DYN_API Error : public std::runtime_error {
 public:
  /// Puts the place before the message.
  Error(ErrorCode code, const std::string& message, Where where = {});
  ErrorCode code() const noexcept { return code_; }       ///< the kind of failure
  const Where& where() const noexcept { return where_; }  ///< its place

 private:
  ErrorCode code_;
  Where where_;
};

}  // namespace dyn
