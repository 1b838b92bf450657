// SPDX-License-Identifier: BSD-2-Clause
// Options that Python programs choose by name.
#pragma once

#include <dyn/error.hpp>

#include <initializer_list>
#include <string>
#include <utility>

namespace dyn::python {

/// Returns the value of the choice called `given`. Throws Error(argument), which lists all names, if there is none.
template <class T>
T chosen(const char* option, const std::string& given, std::initializer_list<std::pair<const char*, T>> choices) {
  std::string all;
  for (const auto& [name, value] : choices) {
    if (given == name) return value;
    all += std::string(all.empty() ? "'" : ", '") + name + "'";
  }
  throw Error(ErrorCode::argument, std::string(option) + " is '" + given + "'; it must be one of " + all);
}

}  // namespace dyn::python
