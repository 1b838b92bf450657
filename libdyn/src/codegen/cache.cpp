#include "codegen/cache.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace dyn {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const std::string& why) { throw Error(ErrorCode::file, why, {path.string(), 0, ""}); }

std::uint64_t fnv(const std::string& text, std::uint64_t h) {
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return h ^ (h >> 31);
}

fs::path folderOf(const std::string& given) {
  if (!given.empty()) return given;
  if (const char* own = std::getenv("LIBDYN_CACHE"); own && *own) return own;
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg) return fs::path(xdg) / "libdyn";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "libdyn";
  throw Error(ErrorCode::file, "there is no place for compiled functions: set LIBDYN_CACHE or HOME, or name a folder");
}

/// Workshops of processes that were ended amid their work. No compiler takes a day.
void removeLeftOver(const fs::path& folder) {
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator(); entry.increment(error)) {
    if (!entry->path().filename().string().starts_with("making-")) continue;
    std::error_code gone;
    const auto written = entry->last_write_time(gone);
    if (!gone && fs::file_time_type::clock::now() - written > std::chrono::hours(24)) fs::remove_all(entry->path(), gone);
  }
}

/// Whether it belongs to this user and nobody else can write it.
bool trusted(const fs::path& path, mode_t kind) {
  struct stat s {};
  return lstat(path.c_str(), &s) == 0 && (s.st_mode & S_IFMT) == kind && s.st_uid == geteuid() && (s.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

}  // namespace

std::string digest(const std::string& text) {
  char out[33];
  std::snprintf(out, sizeof out, "%016llx%016llx", static_cast<unsigned long long>(fnv(text, 14695981039346656037u)),
                static_cast<unsigned long long>(fnv(text, 0x9e3779b97f4a7c15u)));
  return out;
}

ObjectCache::ObjectCache(const std::string& given) : folder_(folderOf(given)) {
  std::error_code error;
  const bool made = fs::create_directories(folder_, error);
  if (error) fail(folder_, "cannot be made, to keep compiled functions in: " + error.message());
  if (made) fs::permissions(folder_, fs::perms::owner_all, error);
  if (!trusted(folder_, S_IFDIR))
    fail(folder_, "is refused as a cache of compiled functions: it must be a folder of yours that nobody else can write");
}

std::string ObjectCache::find(const std::string& key) const {
  const fs::path object = folder_ / (key + ".so"), sum = folder_ / (key + ".sum");
  if (!trusted(object, S_IFREG) || !trusted(sum, S_IFREG)) return "";
  try {
    return digest(readFile(object.string())) == readFile(sum.string()) ? object.string() : "";
  } catch (const Error&) {
    return "";  // taken away meanwhile
  }
}

fs::path ObjectCache::workshop() const {
  removeLeftOver(folder_);
  std::string pattern = (folder_ / "making-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) fail(folder_, std::string("cannot be written: ") + std::strerror(errno));
  return pattern;
}

std::string ObjectCache::enter(const std::string& key, const fs::path& object) const {
  const fs::path sum = object.parent_path() / "sum", place = folder_ / (key + ".so");
  replaceFile(sum, digest(readFile(object.string())));
  std::error_code error;
  // An object whose sum is not there yet, or is another's, counts as damaged and is made anew.
  fs::permissions(object, fs::perms::owner_all, error);
  fs::permissions(sum, fs::perms::owner_read | fs::perms::owner_write, error);
  fs::rename(object, place, error);
  if (!error) fs::rename(sum, folder_ / (key + ".sum"), error);
  if (error) fail(place, "cannot be written: " + error.message());
  return place.string();
}

}  // namespace dyn
