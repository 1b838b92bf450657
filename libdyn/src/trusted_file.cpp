// SPDX-License-Identifier: BSD-2-Clause
#include "trusted_file.hpp"

#include <dyn/error.hpp>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

namespace dyn {

namespace {

namespace fs = std::filesystem;

const fs::path library_file = [] {
  Dl_info where;
  std::error_code error;
  const bool found = dladdr(reinterpret_cast<const void*>(&libraryFile), &where) != 0 && where.dli_fname != nullptr;
  return found ? fs::canonical(where.dli_fname, error) : fs::path();
}();

/// The owner of this library's file already decides what the process does, and so is trusted.
const uid_t library_owner = [] {
  struct stat s {};
  return stat(library_file.c_str(), &s) == 0 ? s.st_uid : 0;
}();

bool trustedOwner(uid_t owner) { return owner == 0 || owner == geteuid() || owner == library_owner; }

std::string judge(const struct stat& s, const std::string& name, const char* cure) {
  const std::string who = "'" + name + "' ";
  if ((s.st_mode & (S_IWGRP | S_IWOTH)) != 0) return who + "can be written by its group or by everyone; run chmod go-w on it" + cure;
  if (!trustedOwner(s.st_uid)) return who + "belongs to another user, number " + std::to_string(s.st_uid) + "; copy it" + cure;
  return "";
}

/// Whether only trusted owners can put another file in this one's place. They must own every folder up to the root. Others may write only to folders
/// where they can remove only their own files, such as /tmp.
bool fixed(const fs::path& file) {
  for (fs::path folder = file.parent_path();; folder = folder.parent_path()) {
    struct stat s {};
    if (lstat(folder.c_str(), &s) != 0 || !S_ISDIR(s.st_mode) || !trustedOwner(s.st_uid)) return false;
    if ((s.st_mode & (S_IWGRP | S_IWOTH)) != 0 && (s.st_mode & S_ISVTX) == 0) return false;
    if (folder == folder.root_path()) return true;
  }
}

}  // namespace

const fs::path& libraryFile() { return library_file; }

OpenFile::OpenFile(const std::string& path) : path_(path) {
  // O_NONBLOCK, since opening a pipe that nobody writes to would wait.
  do descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  while (descriptor_ < 0 && errno == EINTR);
  struct stat s {};
  if (descriptor_ < 0 || fstat(descriptor_, &s) != 0) {
    problem_ = std::string("cannot be opened: ") + std::strerror(errno);
  } else if (!S_ISREG(s.st_mode)) {
    problem_ = "is not a file";
  }
}

OpenFile::~OpenFile() {
  if (descriptor_ >= 0 && !stays_open_) close(descriptor_);
}

OpenFile::OpenFile(OpenFile&& other) noexcept
    : path_(std::move(other.path_)),
      problem_(std::move(other.problem_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      stays_open_(other.stays_open_) {}

std::string OpenFile::untrusted(const char* cure) const {
  struct stat s {};
  fstat(descriptor_, &s);
  return judge(s, path_, cure);
}

bool OpenFile::ownedByUser() const {
  struct stat s {};
  return fstat(descriptor_, &s) == 0 && s.st_uid == geteuid();
}

std::string OpenFile::content() const {
  std::string text;
  char chunk[1 << 16];
  for (off_t at = 0;;) {
    const ssize_t n = pread(descriptor_, chunk, sizeof chunk, at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw Error(ErrorCode::file, std::string("cannot be read: ") + std::strerror(errno), {path_, 0, ""});
    if (n == 0) return text;
    text.append(chunk, static_cast<std::size_t>(n));
    at += n;
  }
}

std::string OpenFile::nameForLoader() const {
  stays_open_ = stays_open_ || !fixed(path_);
  return stays_open_ ? "/proc/self/fd/" + std::to_string(descriptor_) : path_;
}

std::string untrustedFolder(const std::string& path, const char* cure) {
  struct stat s {};
  if (stat(path.c_str(), &s) != 0) return "'" + path + "' cannot be looked at: " + std::strerror(errno) + "; make it readable" + cure;
  return judge(s, path, cure);
}

}  // namespace dyn
