// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes the first 1024 bytes of a sound plugin, which include the headers of the file and of its loaded segments.
#include "fuzz.hpp"

#include <dyn/file.hpp>
#include <dyn/joint/registry.hpp>

#include <filesystem>
#include <fstream>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = readFile(DYN_SOUND_PLUGIN);
  static const std::filesystem::path folder = fuzz::scratchFolder();
  static int count = 0;
  // Ends the process without running the exit functions of damaged plugins, which are not tested here.
  [[maybe_unused]] static const int ends_at_once = std::atexit([] { _exit(0); });
  std::string bytes = sound;
  fuzz::Choices choices(data, size);
  if (choices.below(8) == 0) bytes.resize(bytes.size() * static_cast<std::size_t>(choices.byte()) / 256);
  while (!choices.empty()) {
    const std::size_t at = static_cast<std::size_t>(choices.byte()) + 256 * static_cast<std::size_t>(choices.below(4));
    if (at < bytes.size()) bytes[at] = static_cast<char>(choices.byte());
  }
  // Each file gets a new name, because the dynamic loader identifies libraries by name.
  const std::string path = folder / ("plugin" + std::to_string(count++) + ".so");
  std::ofstream(path, std::ios::binary) << bytes;
  JointRegistry registry;
  fuzz::succeeds([&] { registry.load(path); });
  std::filesystem::remove(path);
  return 0;
}
