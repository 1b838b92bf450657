// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes SRDF files: groups, named states, and pairs of links that need no collision check.
#include "fuzz.hpp"

#include <dyn/parsers/srdf.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Model model;
  JointDescription joint;
  joint.type = "fixed";
  for (const char* name : {"a", "b", "c"}) {
    joint.name = std::string("to_") + name;
    model.addBody(name, 0, joint, {});
  }
  const bool read = fuzz::succeeds([&] { srdf::parse(std::string(reinterpret_cast<const char*>(data), size), "fuzz.srdf", model); });
  const bool nothing = model.disabled_collisions.empty() && model.notes.empty() && model.groups.empty() && model.configurations.empty();
  if (!read && !nothing) fuzz::finding("a file that was refused has left something");
  // The names that stay in groups are those of the model.
  for (const GroupDescription& group : model.groups) model.jointsOf(group.name);
  // A written SRDF must read back as the same pairs.
  Model again = model;
  again.disabled_collisions.clear();
  srdf::parse(srdf::text("robot", model.disabled_collisions), "again.srdf", again);
  if (again.disabled_collisions.size() != model.disabled_collisions.size()) fuzz::finding("an SRDF that was written reads back as another");
  return 0;
}
