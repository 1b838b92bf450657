// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes URDF text: reads and compiles it, runs every algorithm, and computes collisions and distances of its volumes.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/urdf.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string text(reinterpret_cast<const char*>(data), size);
  urdf::Options options;
  options.root = size % 2 ? "free_flyer" : "fixed";
  options.mimic = size % 3 ? urdf::Mimic::coupled : urdf::Mimic::independent;
  options.inertias = size % 5 ? urdf::Inertias::physical : urdf::Inertias::any;
  fuzz::succeeds([&] {
    const Model description = urdf::parse(text, "fuzz.urdf", options);
    const CompactModel model = compile(description, registry);
    fuzz::exercise(description, model, size);
    fuzz::exerciseVolumes(description, model);
  });
  return 0;
}
