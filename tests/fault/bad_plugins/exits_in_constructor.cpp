// SPDX-License-Identifier: BSD-2-Clause
// A static constructor ends the process with exit code 0.
#include <cstdlib>

namespace {
struct Leaver {
  Leaver() { std::exit(0); }
} const leaver;
}  // namespace
