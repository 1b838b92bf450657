// SPDX-License-Identifier: BSD-2-Clause
// Opens the table of kernels for the instruction set that this process uses.
#include "joint/processor.hpp"
#include "kernels/isa/constraint_table.hpp"
#include "trusted_file.hpp"

#include <dyn/error.hpp>

#include <dlfcn.h>

#include <string>

namespace dyn::kernels {

namespace {

/// Opens a module in libdyn/kernels, a folder next to the library. Modules are never closed. Returns null and sets `problem` on failure.
const Kernels* open(const OpenFile& module, std::string& problem) {
  problem = !module.problem().empty() ? module.problem() : module.untrusted("");
  if (!problem.empty()) return nullptr;
  void* library = dlopen(module.nameForLoader().c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    problem = dlerror();
    return nullptr;
  }
  const auto entry = reinterpret_cast<const Kernels* (*)()>(dlsym(library, "dyn_kernels"));
  const Kernels* table = entry ? entry() : nullptr;
  if (table != nullptr && table->layout == layoutStamp() && table->constraints->layout == constraintLayoutStamp()) return table;
  problem = "it belongs to another libdyn";
  return nullptr;
}

const Kernels& choose() {
  const std::string& set = instructionSet();
  const OpenFile module((libraryFile().parent_path() / "libdyn" / "kernels" / (set + ".so")).string());
  std::string problem;
  if (const Kernels* table = open(module, problem)) return *table;
  throw Error(ErrorCode::file, "the kernels for " + set + " cannot be loaded: " + problem + "; they are installed with the library",
              {module.path(), 0, ""});
}

}  // namespace

const Kernels& active() {
  static const Kernels& chosen = choose();
  return chosen;
}

bool useLaneGroups(const CompactImpl& m) { return m.lane_groups.uses.rnea && active().lane_groups.bytes != nullptr; }

bool useLaneGroupsForDerivatives(const CompactImpl& m) { return m.lane_groups.uses.derivatives && active().single.laneGroupBytes != nullptr; }

const PackedKernels* packed(const CompactImpl& m, bool LaneGroupUses::*algorithm) {
  if (useLaneGroups(m) && m.lane_groups.uses.*algorithm) return &active().lane_groups;
  return active().vectored.bytes != nullptr ? &active().vectored : nullptr;
}

}  // namespace dyn::kernels
