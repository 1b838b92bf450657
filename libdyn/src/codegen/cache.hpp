// Compiled functions on disk, each a shared object and its check sum. Entries appear whole or not at all.
#pragma once

#include <filesystem>
#include <string>

namespace dyn {

/// Sixteen hexadecimal digits each of two hashes of the text.
std::string digest(const std::string& text);

class ObjectCache {
 public:
  /// Makes the folder, for this user alone. Throws Error(file) if that fails, or if it is another user's or others can write it.
  explicit ObjectCache(const std::string& given);

  /// Path of the entry if it is there, this user's, not writable by others, and whole; else empty.
  std::string find(const std::string& key) const;
  /// A folder of the caller's own in the cache, for what becomes an entry; the caller removes it. Those that others left a day ago are removed.
  /// Throws Error(file).
  std::filesystem::path workshop() const;
  /// Moves a finished object in; of two that come at once one stays. Returns its path. Throws Error(file).
  std::string enter(const std::string& key, const std::filesystem::path& object) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dyn
