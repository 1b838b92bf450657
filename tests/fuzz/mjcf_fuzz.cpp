// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes MJCF text: reads and compiles it, runs every algorithm, and computes collisions and distances of its volumes.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/mjcf.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string text(reinterpret_cast<const char*>(data), size);
  LoadOptions options;
  options.root = size % 7 ? "fixed" : "free_flyer";
  options.inertias = size % 5 ? Inertias::physical : Inertias::any;
  fuzz::succeeds([&] {
    // The folder does not exist, so that no file of this machine is read.
    const Model description = mjcf::parse(text, "/nowhere/fuzz.xml", options);
    if (description.bodies.size() > 1000) return;
    const CompactModel model = compile(description, registry);
    fuzz::exercise(description, model, size);
    fuzz::exerciseVolumes(description, model);
  });
  return 0;
}
