// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes SDF text: reads and compiles it, and runs every algorithm.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/sdf.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string text(reinterpret_cast<const char*>(data), size);
  LoadOptions options;
  options.root = size % 2 ? "free_flyer" : "fixed";
  options.mimic = size % 3 ? Mimic::coupled : Mimic::independent;
  options.inertias = size % 5 ? Inertias::physical : Inertias::any;
  fuzz::succeeds([&] {
    const Model description = sdf::parse(text, "fuzz.sdf", options);
    fuzz::exercise(description, compile(description, registry), size);
  });
  return 0;
}
