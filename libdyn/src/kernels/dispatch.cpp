// Opens the table of kernels for the instruction set that this process has chosen.
#include "joint/processor.hpp"
#include "kernels/constraint_table.hpp"

#include <dyn/error.hpp>

#include <dlfcn.h>

#include <string>

namespace dyn::kernels {

namespace {

/// Modules lie in libdyn/kernels beside the library. They are never closed.
std::string moduleFile(const std::string& name) {
  Dl_info where;
  if (dladdr(reinterpret_cast<const void*>(&moduleFile), &where) == 0 || where.dli_fname == nullptr) return "";
  const std::string library = where.dli_fname;
  const std::size_t slash = library.rfind('/');
  return (slash == std::string::npos ? "." : library.substr(0, slash)) + "/libdyn/kernels/" + name + ".so";
}

const Kernels* open(const std::string& name, std::string& problem) {
  void* library = dlopen(moduleFile(name).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    problem = dlerror();
    return nullptr;
  }
  const auto entry = reinterpret_cast<const Kernels* (*)()>(dlsym(library, "dyn_kernels"));
  const Kernels* table = entry ? entry() : nullptr;
  if (table == nullptr || table->layout != layoutStamp() || table->constraints->layout != constraintLayoutStamp()) {
    problem = moduleFile(name) + " belongs to another libdyn";
    return nullptr;
  }
  return table;
}

const Kernels& choose() {
  const std::string& set = instructionSet();
  std::string problem;
  if (const Kernels* table = open(set, problem)) return *table;
  throw Error(ErrorCode::file, "the kernels for " + set + " cannot be opened: " + problem + "; they are installed with the library",
              {moduleFile(set), 0, ""});
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
