// SPDX-License-Identifier: BSD-2-Clause
#include "dispatch/contest.hpp"

namespace dyn::benchmark {

void addStaticDispatch(const std::shared_ptr<Memory>& memory, std::vector<Contender>& out) {
  if (!memory->scene.outside.empty()) return;
  const int joints = memory->scene.m.bodies() - 1;
  addOrder<PerJointVariant>(memory, "static_variant", joints, joints, out);
  if (memory->scene.uniform) addOrder<Monomorphic>(memory, "monomorphic", 0, 0, out);
}

}  // namespace dyn::benchmark
