// SPDX-License-Identifier: BSD-2-Clause
// Finds out who may have written a file. The open file is checked and not its name, which can mean another file a moment later.
#pragma once

#include <filesystem>
#include <string>

namespace dyn {

/// The path of this library with all links resolved. It is found as the library is loaded: its name may be relative, and the process may go to
/// another folder later.
const std::filesystem::path& libraryFile();

/// A regular file, open for reading.
class OpenFile {
 public:
  /// Never throws; problem() says what is wrong.
  explicit OpenFile(const std::string& path);
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&&) = delete;

  /// Why the file is not open or not a regular file; empty if it is both.
  const std::string& problem() const { return problem_; }
  /// Why others than root, this process's user and the owner of this library may have written the file, and what to do about it; empty if they cannot
  /// have. `cure` is added to the text.
  std::string untrusted(const char* cure) const;
  bool ownedByUser() const;
  /// Returns all bytes. Throws Error(file) if they cannot be read.
  std::string content() const;

  const std::string& path() const { return path_; }
  /// Returns a name by which the dynamic loader opens exactly this file: the path if nobody else can replace a folder on it, else that of the
  /// descriptor, by which debuggers do not find the file. The descriptor then stays open for good: the loader identifies libraries by their names,
  /// and its number must not come to mean another file.
  std::string nameForLoader() const;

 private:
  std::string path_, problem_;
  int descriptor_ = -1;
  mutable bool stays_open_ = false;
};

/// The same for a folder: why others than these three can write to it; empty if they cannot.
std::string untrustedFolder(const std::string& path, const char* cure);

}  // namespace dyn
