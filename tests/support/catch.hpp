// SPDX-License-Identifier: BSD-2-Clause
// Catch2, version 2 or 3, with the same names.
#pragma once

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>
#else
#include <catch2/catch.hpp>
#endif

#include <string>

namespace dyn::test {

/// Compares with a relative tolerance. .epsilon() sets it; .margin() sets an absolute one.
inline auto approx(double x) {
#if __has_include(<catch2/catch_all.hpp>)
  return Catch::Approx(x);
#else
  return Catch::Detail::Approx(x);
#endif
}

/// Matches strings that contain `text`.
inline auto containing(const std::string& text) {
#if __has_include(<catch2/catch_all.hpp>)
  return Catch::Matchers::ContainsSubstring(text);
#else
  return Catch::Matchers::Contains(text);
#endif
}

}  // namespace dyn::test
