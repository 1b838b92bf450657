// SPDX-License-Identifier: BSD-2-Clause
// Compiled functions on disk, each a shared object and its checksum. Entries appear whole or not at all.
#pragma once

#include "trusted_file.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace dyn {

class ObjectCache {
 public:
  /// Creates the folder for this user alone. Throws Error(file) if that fails, if another user owns the folder, or if others can write to it.
  explicit ObjectCache(const std::string& given);

  /// Returns the entry if it exists, belongs to this user, cannot be written by others, and is whole.
  std::optional<OpenFile> find(const std::string& key) const;
  /// Creates a folder in the cache, where the caller prepares an entry and which the caller removes. Also removes such folders that are older than a
  /// day. Throws Error(file) if the cache cannot be written.
  std::filesystem::path workshop() const;
  /// Moves a finished object into the cache. If two processes enter the same key at once, one object stays. Throws Error(file) if that fails.
  void enter(const std::string& key, const std::filesystem::path& object) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace dyn
