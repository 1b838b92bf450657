// Opens the table of kernels for the instruction set that this process has chosen.
#include "joint/processor.hpp"
#include "kernels/constraint_table.hpp"
#include "trusted_file.hpp"

#include <dyn/error.hpp>

#include <dlfcn.h>

#include <string>

namespace dyn::kernels {

namespace {

/// Modules lie in libdyn/kernels beside the library, and are never closed.
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

bool useStrips(const CompactImpl& m) { return m.strips.uses.rnea && active().strips.bytes != nullptr; }

bool useStripsForDerivatives(const CompactImpl& m) { return m.strips.uses.derivatives && active().single.stripBytes != nullptr; }

const PackedKernels* packed(const CompactImpl& m, bool StripUses::*algorithm) {
  if (useStrips(m) && m.strips.uses.*algorithm) return &active().strips;
  return active().vectored.bytes != nullptr ? &active().vectored : nullptr;
}

}  // namespace dyn::kernels
