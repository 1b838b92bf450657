// SPDX-License-Identifier: BSD-2-Clause
// A static constructor throws while the file is being opened.
#include <stdexcept>

namespace {
struct Thrower {
  Thrower() { throw std::runtime_error("no licence found"); }
} const thrower;
}  // namespace
