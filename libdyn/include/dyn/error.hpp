// The one exception type: what was wrong, where, and what to do about it.
#pragma once

#include <dyn/export.hpp>

#include <stdexcept>
#include <string>

namespace dyn {

enum class ErrorCode {
  argument,    ///< a value that an API call cannot use
  size,        ///< a vector or matrix of the wrong size
  file,        ///< a file that is missing, unreadable or too large
  syntax,      ///< a file that is not what it should be
  model,       ///< a model that describes no mechanism
  joint_type,  ///< a joint type that no loaded plugin provides
  parameter,   ///< a joint parameter that is unknown, missing or ill-typed
  plugin,      ///< a shared object that cannot be loaded
  singular,    ///< a mass matrix that is singular at the given configuration
  compiler,    ///< a compiler that is not there, fails or takes too long
  closure,     ///< constraints that no configuration near the given one keeps
  memory,      ///< more memory than the machine has
  simulation,  ///< a motion that cannot go on: a state that is not finite, steps that collapse, a callback that throws
};

/// The place an error speaks of; empty parts are left out of the message.
struct Where {
  std::string file;
  int line = 0;
  std::string joint;
};

/// Thrown by everything that loads, compiles or checks arguments. `what()` reads "file:line: joint 'j': message".
class DYN_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message, Where where = {});
  ErrorCode code() const noexcept { return code_; }
  const Where& where() const noexcept { return where_; }

 private:
  ErrorCode code_;
  Where where_;
};

}  // namespace dyn
