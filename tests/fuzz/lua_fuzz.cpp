// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes RBDL's Lua models: runs the script in its sandbox, reads and compiles the model, and reads its constraint sets.
#include "exercise.hpp"
#include "fuzz.hpp"

#include <dyn/parsers/lua.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const JointRegistry registry = JointRegistry::standard();
  const std::string text(reinterpret_cast<const char*>(data), size);
  LoadOptions options;
  options.order = size % 2 ? Order::file : Order::name;
  options.inertias = size % 5 ? Inertias::physical : Inertias::any;
  fuzz::succeeds([&] { lua::parseConstraintSets(text, "fuzz.lua"); });
  fuzz::succeeds([&] {
    const Model description = lua::parse(text, "fuzz.lua", options);
    fuzz::exercise(description, compile(description, registry), size);
  });
  return 0;
}
