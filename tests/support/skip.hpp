// Tests that cannot run here say so, and so does ctest; with DYN_REQUIRE_ALL=1, as on the machine that decides, they fail.
#pragma once

#include "support/catch.hpp"

#include <cstdlib>
#include <string>

namespace dyn::test {

constexpr int skipped_exit_code = 100;  ///< of a test program that skipped something and found nothing wrong

inline bool& skippedAny() {
  static bool any = false;
  return any;
}

/// `demanded`: the environment variable that makes a failure of it.
inline void noteSkipped(const std::string& why, const char* demanded) {
  const char* value = std::getenv(demanded);
  if (value && std::string(value) == "1") FAIL("skipped, though " << demanded << "=1: " << why);
  WARN("skipped: " << why);
  skippedAny() = true;
}

}  // namespace dyn::test

/// Leaves the test case where something that it needs is not there.
#define DYN_SKIP(why)                               \
  do {                                              \
    dyn::test::noteSkipped(why, "DYN_REQUIRE_ALL"); \
    return;                                         \
  } while (false)
