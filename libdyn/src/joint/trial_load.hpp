// Whether the static constructors of a shared object let it be opened, and its tables let it be read.
//
// An exception out of one cannot be caught in this process: dlopen is declared not to throw, so the runtime ends the program; and
// called in a way that hides this, it does throw, but leaves the dynamic loader locked for all other threads. A constructor that crashes, ends the
// process or never ends is no better. So each file is opened in a forked child first, whatever its tables say of constructors: those of libraries
// that it needs run, too, and functions that choose others. What will be read of it is read there first, for tables that are damaged are followed
// into memory that is not there.
#pragma once

#include "trusted_file.hpp"

#include <functional>

namespace dyn {

/// What was wrong: the exception's text, the signal, that the file is cut short, that no answer came within ten seconds, or why there was no trial.
/// Empty if the file can be opened and read(library) comes to an end, or if the one or the other will report the error itself.
std::string trialLoad(const OpenFile& file, const std::function<void(void* library)>& read);

}  // namespace dyn
