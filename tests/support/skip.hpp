// SPDX-License-Identifier: BSD-2-Clause
// Tests that cannot run here report that they are skipped, and so does ctest. With DYN_REQUIRE_ALL=1, as on the machine that decides, they fail.
#pragma once

#include "support/catch.hpp"

#include <cstdlib>
#include <string>

namespace dyn::test {

constexpr int skipped_exit_code = 100;  ///< exit code of a test program that skipped tests and had no failure

inline bool& skippedAny() {
  static bool any = false;
  return any;
}

/// Notes that a test was skipped. This is a failure if the environment variable `demanded` is 1.
inline void noteSkipped(const std::string& why, const char* demanded) {
  const char* value = std::getenv(demanded);
  if (value && std::string(value) == "1") FAIL("skipped, though " << demanded << "=1: " << why);
  WARN("skipped: " << why);
  skippedAny() = true;
}

}  // namespace dyn::test

/// Leaves the test case because something that it needs is missing.
#define DYN_SKIP(why)                               \
  do {                                              \
    dyn::test::noteSkipped(why, "DYN_REQUIRE_ALL"); \
    return;                                         \
  } while (false)
