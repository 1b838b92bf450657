// SPDX-License-Identifier: BSD-2-Clause
#include "dispatch/contest.hpp"

namespace dyn::benchmark {

Contest dispatchContest(const CompactModel& model) {
  const auto memory = std::make_shared<Memory>(model);
  Contest contest;
  addVirtualDispatch(memory, contest.contenders);
  addStaticDispatch(memory, contest.contenders);
  std::string outside;
  for (const std::string& name : memory->scene.outside) outside += (outside.empty() ? "'" : ", '") + name + "'";
  if (!outside.empty()) {
    contest.missing = "virtual_per_joint, static_variant, monomorphic: they are made of a closed set of types, which lacks the plugins' " + outside;
  } else if (!memory->scene.uniform)
    contest.missing = "monomorphic: the model has other joints than revolute ones below its root";
  return contest;
}

}  // namespace dyn::benchmark
