// SPDX-License-Identifier: BSD-2-Clause
// The order of the source tree: every folder of the library is described, and small enough to be looked through.
#include "support/catch.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

const fs::path library = fs::path(DYN_SOURCE_DIR) / "libdyn";

std::vector<fs::path> foldersIn(const fs::path& folder) {
  std::vector<fs::path> out;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_directory()) out.push_back(entry.path());
  return out;
}

std::string contents(const fs::path& file) {
  std::ostringstream out;
  out << std::ifstream(file).rdbuf();
  return out.str();
}

int filesIn(const fs::path& folder) {
  int count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) count += entry.is_regular_file() ? 1 : 0;
  return count;
}

}  // namespace

TEST_CASE("libdyn/README.md has a row for every folder of the library, and for no other", "[house]") {
  const std::string readme = contents(library / "README.md");
  std::vector<std::string> names;
  for (const fs::path& parent : {library / "include" / "dyn", library / "src", library / "src" / "kernels"})
    for (const fs::path& folder : foldersIn(parent)) names.push_back(folder.filename().string());
  std::vector<std::string> rows;
  std::istringstream lines(readme.substr(0, readme.find("\n## ")));  // the tables of folders
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::string row = line.substr(3, line.find('`', 3) - 3);
    rows.push_back(row);
  }
  // A folder with a public and an internal part has one row; src/constraint and kernels/constraint have two.
  for (const std::string& name : names) {
    INFO(name);
    const bool twice =
        fs::exists(library / "src" / "kernels" / name) && (fs::exists(library / "src" / name) || fs::exists(library / "include" / "dyn" / name));
    CHECK(std::count(rows.begin(), rows.end(), name) == (twice ? 2 : 1));
  }
  for (const std::string& row : rows) {
    INFO(row);
    CHECK(std::count(names.begin(), names.end(), row) > 0);
  }
}

TEST_CASE("no folder of the library has more than 25 files", "[house]") {
  for (const fs::path& parent : {library / "include", library / "src", library / "sdk"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(parent)) {
      if (!entry.is_directory()) continue;
      INFO(entry.path().string());
      CHECK(filesIn(entry.path()) <= 25);
    }
}

TEST_CASE("files of the kernels are in rooms", "[house]") {
  for (const fs::directory_entry& entry : fs::directory_iterator(library / "src" / "kernels"))
    if (entry.is_regular_file()) CHECK(entry.path().filename() == "README.md");
}
