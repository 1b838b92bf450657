// SPDX-License-Identifier: BSD-2-Clause
// Shared by the fuzz targets: bytes used as choices and as files, and calls that may fail only with dyn::Error.
#pragma once

#include <dyn/error.hpp>

#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

namespace dyn::fuzz {

/// Draws numbers from the bytes of an input. Gives zeros when the bytes are used up.
class Choices {
 public:
  Choices(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  int below(int n) { return byte() % n; }
  /// Returns mostly ordinary numbers, sometimes extreme ones.
  double number() {
    static constexpr double odd[] = {0, -0.0, 1, -1, 1e-300, 1e300, 1e-12, 1e12, 1e-6, 1e6, 3.141592653589793, 5e-324};
    const int kind = byte();
    if (kind >= 224) return odd[kind % 12];
    return (byte() - 127.5) / 64 + byte() / 16384.0;
  }
  /// Returns all remaining bytes.
  std::string rest() {
    std::string text(reinterpret_cast<const char*>(data_), size_);
    size_ = 0;
    return text;
  }
  bool empty() const { return size_ == 0; }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// A file in memory that has a path.
class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes) : file_(memfd_create("fuzz", MFD_CLOEXEC)) {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t n = write(file_, bytes.data() + done, bytes.size() - done);
      if (n <= 0) std::abort();
      done += static_cast<std::size_t>(n);
    }
  }
  ~MemoryFile() { close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// Makes a folder in memory for the files of one target; tools/fuzz removes it.
inline std::filesystem::path scratchFolder() {
  std::string pattern = "/dev/shm/libdyn-fuzz-XXXXXX";
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  return pattern;
}

/// Aborts the process, which the fuzzer reports as a finding.
[[noreturn]] inline void finding(const std::string& what) {
  std::fprintf(stderr, "FINDING: %s\n", what.c_str());
  std::abort();
}

/// Returns whether the call succeeded. It may throw dyn::Error with a message; any other exception is a finding.
template <class Call>
bool succeeds(const Call& call) {
  try {
    call();
    return true;
  } catch (const Error& e) {
    if (std::strlen(e.what()) == 0) finding("an error without a message");
    return false;
  }
}

}  // namespace dyn::fuzz
