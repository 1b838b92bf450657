// Compiled functions on disk, each a shared object and its check sum. Entries appear whole or not at all.
#pragma once

#include "trusted_file.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace dyn {

class ObjectCache {
 public:
  /// Makes the folder, for this user alone. Throws Error(file) if that fails, or if it is another user's or others can write it.
  explicit ObjectCache(const std::string& given);

  /// The entry if it is there, this user's, not writable by others, and whole.
  std::optional<OpenFile> find(const std::string& key) const;
  /// A folder of the caller's own in the cache, for what becomes an entry; the caller removes it. Those that others left a day ago are removed.
  /// Throws Error(file).
  std::filesystem::path workshop() const;
  /// Moves a finished object in; of two that come at once one stays. Throws Error(file).
  void enter(const std::string& key, const std::filesystem::path& object) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dyn
