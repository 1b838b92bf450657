#include <dyn/error.hpp>
#include <dyn/file.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyn {

namespace {

/// A new file beside `path`, with the rights of any new file: whatever lies there under its name, a link that someone planted too, is not touched.
/// -1 if there can be none.
int makeBeside(const std::string& path, std::string& name) {
  static std::atomic<unsigned> count{0};
  int file;
  do {
    name = path + ".part" + std::to_string(getpid()) + "-" + std::to_string(count++);
    file = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (file < 0 && (errno == EEXIST || errno == EINTR));
  return file;
}

bool writeAndClose(int file, const std::string& content) {
  for (std::size_t done = 0; done < content.size();) {
    const ssize_t n = write(file, content.data() + done, content.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int why = errno;
      close(file);
      errno = why;
      return false;
    }
    done += static_cast<std::size_t>(n);
  }
  return close(file) == 0;
}

}  // namespace

std::string readFile(const std::string& path, std::uintmax_t largest) {
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
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw Error(ErrorCode::file, "cannot be written: it is a folder", {path, 0, ""});
  std::string temporary;
  const int file = makeBeside(path, temporary);
  if (file < 0) throw Error(ErrorCode::file, std::string("cannot be written: ") + std::strerror(errno), {path, 0, ""});
  close(file);
  std::remove(temporary.c_str());
}

void replaceFile(const std::string& path, const std::string& content) {
  std::string temporary;
  const int file = makeBeside(path, temporary);
  if (file >= 0 && writeAndClose(file, content) && std::rename(temporary.c_str(), path.c_str()) == 0) return;
  const std::string why = std::strerror(errno);
  if (file >= 0) std::remove(temporary.c_str());
  throw Error(ErrorCode::file, "cannot be written: " + why, {path, 0, ""});
}

}  // namespace dyn
