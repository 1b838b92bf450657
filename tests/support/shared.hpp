// Reference data beside the project. Tests that need it skip, with a message, where it is not.
#pragma once

#include "support/catch.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace dyn::test {

/// DYN_SHARED, or ../shared beside the sources; empty if neither is there.
inline std::string sharedFolder() {
  const char* given = std::getenv("DYN_SHARED");
  const std::filesystem::path folder = given ? std::filesystem::path(given) : std::filesystem::path(DYN_SOURCE_DIR) / ".." / "shared";
  return std::filesystem::is_directory(folder) ? std::filesystem::canonical(folder).string() : std::string();
}

inline nlohmann::json readJson(const std::string& path) {
  std::ifstream file(path);
  REQUIRE(file.good());
  return nlohmann::json::parse(file);
}

}  // namespace dyn::test

/// Leaves the test case when the reference data is absent.
#define DYN_NEEDS_SHARED()                                                         \
  if (dyn::test::sharedFolder().empty()) {                                         \
    WARN("skipped: no reference data (set DYN_SHARED to the folder that has it)"); \
    return;                                                                        \
  }
