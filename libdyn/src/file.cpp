// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyn {

namespace {

[[noreturn]] void cannotWrite(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::file, "cannot be written: " + why, {path, 0, ""});
}
[[noreturn]] void cannotWrite(const std::string& path) { cannotWrite(path, std::strerror(errno)); }

/// The file that a path leads to, and how it is written.
struct Target {
  std::string file;    ///< with links resolved
  bool there = false;  ///< a file of that name exists
  bool whole = true;   ///< written by replacing it; not so devices, pipes, and files that a process has open, as /dev/stdout
  struct stat before {};
};

/// Throws Error(file) for folders, for files that this process may not write, and for read-only files even if root could write them.
Target targetOf(const std::string& path) {
  if (path.empty()) throw Error(ErrorCode::file, "the name of a file to write is empty");
  Target out;
  out.file = path;
  for (int links = 0; links < 40; ++links) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(out.file, error);
    if (error) break;
    if (out.file.starts_with("/proc/")) break;  // a descriptor's link may lead to a file that no path leads to
    out.file = (std::filesystem::path(out.file).parent_path() / next).string();
  }
  out.there = stat(out.file.c_str(), &out.before) == 0;
  if (!out.there) return out;
  if (S_ISDIR(out.before.st_mode)) cannotWrite(path, "it is a folder");
  out.whole = S_ISREG(out.before.st_mode) && !out.file.starts_with("/proc/");
  if (S_ISREG(out.before.st_mode) && (out.before.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0)
    cannotWrite(path, "it is read-only; run chmod u+w on it, or give another name");
  if (faccessat(AT_FDCWD, out.file.c_str(), W_OK, AT_EACCESS) != 0) cannotWrite(path);
  return out;
}

/// Creates a new file beside another, with the permissions of any new file. A file that exists under the new name, such as a link that someone
/// planted, is not touched. Returns -1 if the file cannot be created.
int makeBeside(const std::string& path, std::string& name) {
  static std::atomic<unsigned> count{0};
  int file;
  do {
    name = path + ".part" + std::to_string(getpid()) + "-" + std::to_string(count++);
    file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && (errno == EEXIST || errno == EINTR));
  return file;
}

bool writeAll(int file, const std::string& content) {
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t n = write(file, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Closes the file in any case. Returns false if `well` is false or closing fails; errno is that of the first failure.
bool finish(int file, bool well) {
  const int why = errno;
  const bool closed = close(file) == 0;
  if (!well) errno = why;
  return well && closed;
}

/// Writes into the existing file: it is not a regular file, or must not be replaced by another.
void writeInto(const Target& target, const std::string& path, const std::string& content) {
  int file;
  do file = open(target.file.c_str(), O_WRONLY | O_CLOEXEC | (S_ISREG(target.before.st_mode) ? O_TRUNC : 0));
  while (file < 0 && errno == EINTR);
  if (file < 0 || !finish(file, writeAll(file, content))) cannotWrite(path);
}

}  // namespace

std::string readFile(const std::string& path, std::uintmax_t largest) {
  if (path.empty()) throw Error(ErrorCode::file, "the name of a file to read is empty");
  const Where where{path, 0, ""};
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ErrorCode::file, "does not exist", where);
  if (std::filesystem::is_directory(status)) throw Error(ErrorCode::file, "is a folder; give the file", where);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(ErrorCode::file, std::string("cannot be opened: ") + std::strerror(errno), where);
  std::string text;
  char chunk[1 << 16];
  while (file.read(chunk, sizeof chunk) || file.gcount() > 0) {
    text.append(chunk, static_cast<std::size_t>(file.gcount()));
    if (text.size() > largest)
      throw Error(ErrorCode::file, "is larger than " + std::to_string(largest >> 20) + " MB, the most that is read of such a file", where);
  }
  if (file.bad()) throw Error(ErrorCode::file, "cannot be read", where);
  return text;
}

void checkReplaceable(const std::string& path) {
  const Target target = targetOf(path);
  if (!target.whole) return;
  std::string temporary;
  const int file = makeBeside(target.file, temporary);
  if (file < 0) cannotWrite(path);
  close(file);
  std::remove(temporary.c_str());
}

void replaceFile(const std::string& path, const std::string& content) {
  const Target target = targetOf(path);
  if (!target.whole) return writeInto(target, path, content);
  std::string temporary;
  const int file = makeBeside(target.file, temporary);
  if (file < 0) cannotWrite(path);
  // A file keeps its owner and group. If this process cannot give a new file to them, it writes into the existing one.
  const bool theirs = target.there && (target.before.st_uid != geteuid() || target.before.st_gid != getegid());
  if (theirs && fchown(file, target.before.st_uid, target.before.st_gid) != 0) {
    close(file);
    std::remove(temporary.c_str());
    return writeInto(target, path, content);
  }
  const bool written = (!target.there || fchmod(file, target.before.st_mode & 07777) == 0) && writeAll(file, content) && fsync(file) == 0;
  if (finish(file, written) && std::rename(temporary.c_str(), target.file.c_str()) == 0) return;
  const std::string why = std::strerror(errno);
  std::remove(temporary.c_str());
  cannotWrite(path, why);
}

}  // namespace dyn
