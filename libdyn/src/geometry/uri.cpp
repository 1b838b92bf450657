// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/files.hpp"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <filesystem>

namespace dyn {

namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t largest_file = std::uintmax_t{512} << 20;

std::string existing(const fs::path& path) {
  std::error_code error;
  return fs::is_regular_file(path, error) ? path.lexically_normal().string() : "";
}

/// Appends the folders that an environment variable lists, separated by colons, each followed by `below`.
void addFrom(const char* variable, const char* below, std::vector<fs::path>& folders) {
  const char* value = secure_getenv(variable);
  if (value == nullptr) return;
  const std::string text = value;
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t last = std::min(text.find(':', first), text.size());
    if (last > first) folders.push_back(fs::path(text.substr(first, last - first)) / below);
    first = last + 1;
  }
}

/// Decodes the percent codes of a URI, such as %20 for a blank (RFC 3986, sec. 2.1). Anything else stays as it is.
std::string decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned value = 0;
    const char* digits = text.data() + i + 1;
    if (text[i] == '%' && i + 2 < text.size() && std::from_chars(digits, digits + 2, value, 16).ptr == digits + 2) {
      out += static_cast<char>(value);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::string inPackages(const std::string& rest, const std::vector<std::string>& packages) {
  std::vector<fs::path> folders(packages.begin(), packages.end());
  addFrom("ROS_PACKAGE_PATH", "", folders);
  addFrom("AMENT_PREFIX_PATH", "share", folders);
  const std::size_t slash = rest.find('/');
  if (slash == std::string::npos) return "";
  const std::string package = rest.substr(0, slash), path = rest.substr(slash + 1);
  for (const fs::path& folder : folders) {
    if (std::string found = existing(folder / package / path); !found.empty()) return found;
    // The folder may be the package itself; a path that ends in '/' has an empty last part.
    const fs::path itself = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    if (itself != package) continue;
    if (std::string found = existing(folder / path); !found.empty()) return found;
  }
  return "";
}

}  // namespace

std::string resolveUri(const std::string& uri, const std::vector<std::string>& packages, const std::string& beside) {
  for (const std::string scheme : {"package://", "model://"})
    if (uri.starts_with(scheme)) return inPackages(uri.substr(scheme.size()), packages);
  if (uri.starts_with("file://")) return existing(decoded(uri.substr(7)));
  const fs::path path(uri);
  return existing(path.is_absolute() ? path : fs::path(beside).parent_path() / path);
}

void checkFileSize(const std::string& path, const std::string& usual) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error) throw Error(ErrorCode::file, "cannot be read: " + error.message(), {path, 0, ""});
  if (bytes > largest_file) throw Error(ErrorCode::file, "is larger than 512 MB; " + usual, {path, 0, ""});
}

}  // namespace dyn
