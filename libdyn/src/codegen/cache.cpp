// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/cache.hpp"

#include "digest.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

namespace dyn {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& why) { throw Error(ErrorCode::file, why, {path.string(), 0, ""}); }

fs::path named(const std::string& given) {
  if (!given.empty()) return given;
  if (const char* own = secure_getenv("LIBDYN_CACHE"); own && *own) return own;
  if (const char* xdg = secure_getenv("XDG_CACHE_HOME"); xdg && *xdg) return fs::path(xdg) / "libdyn";
  if (const char* home = secure_getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "libdyn";
  throw Error(ErrorCode::file, "there is no place for compiled functions: set LIBDYN_CACHE or HOME, or name a folder");
}

/// The folder without a slash at its end: with the slash, lstat would follow a link.
fs::path folderOf(const std::string& given) {
  fs::path folder = fs::absolute(named(given));
  while (!folder.has_filename() && folder.has_relative_path()) folder = folder.parent_path();
  return folder;
}

/// Removes the workshops of processes that were killed while they worked. No compiler takes a day.
void removeLeftOver(const fs::path& folder) {
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (!entry->path().filename().string().starts_with("making-")) continue;
    std::error_code gone;
    const auto written = entry->last_write_time(gone);
    if (!gone && fs::file_time_type::clock::now() - written > std::chrono::hours(24)) fs::remove_all(entry->path(), gone);
  }
}

/// Whether the path is a folder, and not a link to one, that belongs to this user and that nobody else can write to.
bool trusted(const fs::path& folder) {
  struct stat s {};
  return lstat(folder.c_str(), &s) == 0 && S_ISDIR(s.st_mode) && s.st_uid == geteuid() && (s.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

ObjectCache::ObjectCache(const std::string& given) : folder_(folderOf(given)) {
  fs::path made;
  for (const fs::path& part : folder_) {
    made /= part;
    if (mkdir(made.c_str(), 0700) != 0 && !fs::exists(made))
      fail(made, std::string("cannot be made, to keep compiled functions in: ") + std::strerror(errno));
  }
  if (!trusted(folder_)) fail(folder_, "is refused as a cache of compiled functions: it must be a folder of yours that nobody else can write");
}

std::optional<OpenFile> ObjectCache::find(const std::string& key) const {
  OpenFile object((folder_ / (key + ".so")).string());
  const OpenFile sum((folder_ / (key + ".sum")).string());
  const auto mine = [](const OpenFile& file) { return file.problem().empty() && file.ownedByUser() && file.untrusted("").empty(); };
  if (!mine(object) || !mine(sum) || digest(object.content()) != sum.content()) return std::nullopt;
  return object;
}

fs::path ObjectCache::workshop() const {
  removeLeftOver(folder_);
  std::string pattern = (folder_ / "making-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) fail(folder_, std::string("cannot be written: ") + std::strerror(errno));
  return pattern;
}

void ObjectCache::enter(const std::string& key, const fs::path& object) const {
  const fs::path sum = object.parent_path() / "sum", place = folder_ / (key + ".so");
  replaceFile(sum, digest(readFile(object.string())));
  std::error_code error;
  // A folder in the entry's place did not come from enter(), so it is removed.
  for (const fs::path& entry : {place, folder_ / (key + ".sum")})
    if (fs::is_directory(fs::symlink_status(entry, error))) fs::remove_all(entry, error);
  // Between the two renames the object has no checksum, or that of another object. find() then takes it for damaged, and it is compiled again.
  fs::permissions(object, fs::perms::owner_all, error);
  fs::permissions(sum, fs::perms::owner_read | fs::perms::owner_write, error);
  fs::rename(object, place, error);
  if (!error) fs::rename(sum, folder_ / (key + ".sum"), error);
  if (error) fail(place, "cannot be written: " + error.message());
}

}  // namespace dyn
