// Whether the static constructors of a shared object let it be opened.
//
// An exception out of one cannot be caught in this process: dlopen is declared not to throw, so the runtime ends the program; and
// called in a way that hides this, it does throw, but leaves the dynamic loader locked for all other threads. A constructor that crashes
// is no better. So a file that has constructors is opened in a forked child first; one that has none needs no trial.
#pragma once

#include <string>

namespace dyn {

/// What was wrong: the exception's text, the signal, or that the file is cut short. Empty if the file can be opened, if dlopen will report the error
/// itself, or if the trial was not possible (no fork, or no answer within ten seconds).
std::string trialLoad(const std::string& path);

}  // namespace dyn
