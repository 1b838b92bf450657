// SPDX-License-Identifier: BSD-2-Clause
// A static constructor never returns.
#include <unistd.h>

namespace {
struct Waiter {
  Waiter() {
    while (true) pause();
  }
} const waiter;
}  // namespace
