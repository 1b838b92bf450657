// SPDX-License-Identifier: BSD-2-Clause
#include "version.hpp"

#include <charconv>
#include <cstring>
#include <optional>
#include <utility>

namespace dyn::urdf {

namespace {

using Version = std::pair<unsigned long, unsigned long>;

/// Parses MAJOR.MINOR. A number beyond the range of its type is newer than all.
std::optional<Version> versionOf(const char* text) {
  const char* const end = text + std::strlen(text);
  Version out;
  auto read = std::from_chars(text, end, out.first);
  if (read.ec == std::errc::result_out_of_range) return Version{~0ul, 0};
  if (read.ec != std::errc() || read.ptr == end || *read.ptr != '.') return std::nullopt;
  read = std::from_chars(read.ptr + 1, end, out.second);
  if (read.ec == std::errc::result_out_of_range) out.second = ~0ul;
  return read.ec == std::errc::invalid_argument || read.ptr != end ? std::nullopt : std::optional(out);
}

}  // namespace

void checkVersion(const Document& document, Versions versions) {
  constexpr Version oldest{1, 0}, newest{1, 2};
  const tinyxml2::XMLElement& robot = document.robot();
  const char* text = robot.Attribute("version");
  if (text == nullptr) return;
  const std::string line = "line " + std::to_string(robot.GetLineNum()) + ": ";
  const std::optional<Version> version = versionOf(text);
  if (!version || *version < oldest) {
    document.notes().push_back(line + "version \"" + text + "\" is no version of URDF; the file is read as version 1.0");
  } else if (*version > newest) {
    const std::string what = std::string("the file is of version ") + text + " of URDF, and this libdyn knows 1.0 to 1.2";
    if (versions == Versions::known) document.fail(robot, what + "; use a newer libdyn (Versions::any, --versions any, reads what is understood)");
    document.notes().push_back(line + what + ": parts of it may be missing");
  }
}

}  // namespace dyn::urdf
