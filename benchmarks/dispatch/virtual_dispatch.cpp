// SPDX-License-Identifier: BSD-2-Clause
#include "dispatch/contest.hpp"

namespace dyn::benchmark {

void addVirtualDispatch(const std::shared_ptr<Memory>& memory, std::vector<Contender>& out) {
  const CompactImpl& m = memory->scene.m;
  const int joints = m.bodies() - 1, runs = static_cast<int>(m.runs.size()), types = static_cast<int>(m.batches.size());
  addOrder<PerBatch>(memory, "virtual_per_batch", types, runs, out);
  if (memory->scene.outside.empty()) addOrder<PerJointVirtual>(memory, "virtual_per_joint", joints, joints, out);
}

}  // namespace dyn::benchmark
