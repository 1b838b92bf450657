// SPDX-License-Identifier: BSD-2-Clause
// Messages of libsdformat, as notes and errors instead of text on the terminal.
#pragma once

#include "includes.hpp"

#include <mutex>
#include <sdf/Root.hh>
#include <sstream>
#include <vector>

namespace dyn::sdf {

/// Takes libsdformat's messages while it lives. libsdformat has one console for the process, so that one thread at a time reads SDF.
class Console {
 public:
  Console();
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  /// Notes each line that was said since the last call.
  void note(reader::Notes& notes);

 private:
  std::unique_lock<std::mutex> lock_;
  std::ostringstream said_;
};

/// Throws the first of libsdformat's errors as dyn::Error. Errors about inertias are left out: this library judges them itself.
void throwFirst(const ::sdf::Errors& errors, const Sources& sources);

/// Loads a text.
void load(const Sources& sources, ::sdf::Root& root, reader::Notes& notes);

}  // namespace dyn::sdf
