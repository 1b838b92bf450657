// SPDX-License-Identifier: BSD-2-Clause
// A static constructor aborts the process.
#include <cstdlib>

namespace {
struct Crasher {
  Crasher() { std::abort(); }
} const crasher;
}  // namespace
