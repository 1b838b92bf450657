// SPDX-License-Identifier: BSD-2-Clause
// Finds out whether the static constructors of a shared object let it be opened, and its tables let it be read.
//
// An exception of a static constructor cannot be caught in this process: dlopen is declared not to throw, so the runtime ends the program. If it is
// called in a way that hides this, it does throw, but leaves the dynamic loader locked for all other threads. A constructor that crashes, ends the
// process or never ends is no better. So each file is opened in a forked child first, even if its tables list no constructors: those of libraries
// that it needs run, too, and so do functions that choose others. The child also reads everything that will be read of the file, since damaged tables
// lead into memory that does not exist.
#pragma once

#include "trusted_file.hpp"

#include <functional>

namespace dyn {

/// Returns what was wrong: the exception's text, the signal, that the file is cut short or damaged, that no answer came within ten seconds, or why
/// there was no trial. Returns "" if the file can be opened and read(library) ends. Also returns "" for errors that opening or reading the file
/// in this process will report.
std::string trialLoad(const OpenFile& file, const std::function<void(void* library)>& read);

}  // namespace dyn
