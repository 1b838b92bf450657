// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes the state files of `dyn compute`.
#include "fuzz.hpp"
#include "support/random_model.hpp"

#include <states.hpp>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const CompactModel model = [] {
    const JointRegistry registry = JointRegistry::standard();
    return compile(test::treeOf(registry, {"revolute", "continuous"}, 2, 1), registry);
  }();
  const fuzz::MemoryFile file(std::string(reinterpret_cast<const char*>(data), size));
  fuzz::succeeds([&] {
    for (const tool::State& s : tool::readStates(file.path(), model)) {
      if (s.q.size() != model.nq() || s.v.size() != model.nv() || s.a.size() != model.nv() || s.tau.size() != model.nv())
        fuzz::finding("a state of a wrong size");
      if (!s.q.allFinite() || !s.v.allFinite() || !s.a.allFinite() || !s.tau.allFinite()) fuzz::finding("a state that is not finite");
    }
  });
  return 0;
}
