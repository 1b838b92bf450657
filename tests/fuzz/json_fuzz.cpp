// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes models in libdyn's own format: reads and compiles them, runs every algorithm, and writes them again.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/json.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string text(reinterpret_cast<const char*>(data), size);
  fuzz::succeeds([&] {
    const Model description = json::parse(text, "fuzz.dyn.json");
    const std::string written = json::write(description);
    if (json::write(json::parse(written, "again")) != written) fuzz::finding("a model that is written and read again is another model");
    const CompactModel model = compile(description, registry);
    fuzz::exercise(description, model, size);
    fuzz::exerciseVolumes(description, model);
  });
  return 0;
}
