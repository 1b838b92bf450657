// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes entries in the cache of compiled functions. An accepted entry fits its check sum, belongs to this user alone and is a regular file.
#include "fuzz.hpp"

#include <codegen/cache.hpp>
#include <digest.hpp>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

using namespace dyn;
namespace fs = std::filesystem;

namespace {

/// Writes a file with these bytes, or puts a folder, a link, a pipe or a file with wrong permissions in its place.
void place(const fs::path& path, int kind, const std::string& bytes) {
  fs::remove_all(path);
  if (kind == 1) {
    fs::create_directory(path);
  } else if (kind == 2) {
    fs::create_symlink("/etc/passwd", path);
  } else if (kind == 3) {
    mkfifo(path.c_str(), 0600);
  } else {
    std::ofstream(path, std::ios::binary) << bytes;
    chmod(path.c_str(), kind == 4 ? 0666 : 0600);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fs::path folder = fuzz::scratchFolder();
  static const ObjectCache cache(folder);
  fuzz::Choices choices(data, size);
  const int object = choices.below(6), sum = choices.below(8);
  const bool fits = choices.below(2) != 0;
  const std::string text = choices.rest(), bytes = text.substr(0, text.size() / 2);
  place(folder / "key.so", object, bytes);
  place(folder / "key.sum", sum, fits ? digest(bytes) : text.substr(text.size() / 2));
  const auto entry = cache.find("key");
  if (entry && (object == 1 || object == 3 || object == 4 || sum == 1 || sum == 3 || sum == 4))
    fuzz::finding("it takes what is no file of this user's");
  if (entry && object != 2 && sum != 2 && digest(entry->content()) != digest(bytes)) fuzz::finding("it takes other bytes");
  if (!entry && fits && (object == 0 || object == 5) && (sum == 0 || sum >= 5)) fuzz::finding("it does not take what fits");
  return 0;
}
