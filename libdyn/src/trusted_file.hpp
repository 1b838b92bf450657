// Whom a file's bytes come from. It is asked of the open file and not of its name: a name can mean another file a moment later.
#pragma once

#include <filesystem>
#include <string>

namespace dyn {

/// The file of this library behind all links, looked for as it is loaded: its name may be relative, and the process may go to another folder later.
const std::filesystem::path& libraryFile();

/// A regular file, open for reading.
class OpenFile {
 public:
  /// Throws nothing; see problem().
  explicit OpenFile(const std::string& path);
  ~OpenFile();
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&&) = delete;

  /// Why it is not open, or no regular file; empty if it is.
  const std::string& problem() const { return problem_; }
  /// Why others than root, this process's user and the owner of this library may have written it, with what to do about that; empty if they cannot
  /// have.
  std::string untrusted(const char* cure) const;
  bool ownedByUser() const;
  /// All of its bytes. Throws Error(file).
  std::string content() const;

  const std::string& path() const { return path_; }
  /// A name for the dynamic loader that means this very file: its path where nobody else can exchange a folder on the way, else the descriptor's, by
  /// which debuggers do not find it. The descriptor stays open for good then: the loader knows libraries by their names, and the number must not come
  /// to mean another file.
  std::string nameForLoader() const;

 private:
  std::string path_, problem_;
  int descriptor_ = -1;
  mutable bool stays_open_ = false;
};

/// Why others than these can change a folder; empty if they cannot.
std::string untrustedFolder(const std::string& path, const char* cure);

}  // namespace dyn
