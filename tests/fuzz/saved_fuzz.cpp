// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes saved simulations with a valid and with an invalid check sum.
#include "fuzz.hpp"
#include "support/random_model.hpp"
#include "support/saved.hpp"

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const CompactModel model = [] {
    const JointRegistry registry = JointRegistry::standard();
    return compile(test::treeOf(registry, {"revolute", "spherical"}, 2, 1), registry);
  }();
  std::string text(reinterpret_cast<const char*>(data), size);
  Simulator simulator(model, {.integrator = size % 2 ? Integrator::rk4 : Integrator::dormand_prince});
  const std::string fresh = simulator.save();
  // Most inputs get valid first lines, so that the rest is read at all.
  if (size % 4 != 0) {
    std::size_t lines = 0;
    for (std::size_t at = 0; lines < 2 && at != std::string::npos; ++lines) at = fresh.find('\n', at) + 1;
    const std::size_t second = fresh.find('\n', fresh.find('\n') + 1) + 1;
    text = test::sealed(fresh.substr(0, second) + text);
  }
  const double before = simulator.time();
  if (!fuzz::succeeds([&] { simulator.resume(text); })) {
    if (simulator.time() != before || simulator.save() != fresh) fuzz::finding("a simulation that was refused has left something");
    return 0;
  }
  if (!simulator.q().allFinite() || !simulator.v().allFinite()) fuzz::finding("a state that is not finite");
  fuzz::succeeds([&] { simulator.step(); });
  return 0;
}
