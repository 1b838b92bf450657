// SPDX-License-Identifier: BSD-2-Clause
// Reference data beside the project. Tests that need it are skipped if it is missing, and fail if DYN_SHARED or DYN_REQUIRE_SHARED=1 says that it is
// there.
#pragma once

#include "support/skip.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace dyn::test {

/// The folder DYN_SHARED, or else ../shared beside the sources; empty if the latter does not exist.
inline std::string sharedFolder() {
  const char* given = std::getenv("DYN_SHARED");
  const std::filesystem::path folder = given ? std::filesystem::path(given) : std::filesystem::path(DYN_SOURCE_DIR) / ".." / "shared";
  if (std::filesystem::is_directory(folder)) return std::filesystem::canonical(folder).string();
  if (given) FAIL("DYN_SHARED=" << given << " is no folder");
  return "";
}

inline nlohmann::json readJson(const std::string& path) {
  std::ifstream file(path);
  REQUIRE(file.good());
  return nlohmann::json::parse(file);
}

}  // namespace dyn::test

/// Leaves the test case if the reference data is absent.
#define DYN_NEEDS_SHARED()                                                                                        \
  if (dyn::test::sharedFolder().empty()) {                                                                        \
    dyn::test::noteSkipped("no reference data (set DYN_SHARED to the folder that has it)", "DYN_REQUIRE_SHARED"); \
    return;                                                                                                       \
  }
