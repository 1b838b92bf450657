#include "dispatch/contest.hpp"

namespace dyn::benchmark {

Contest dispatchContest(const CompactModel& model) {
  const auto memory = std::make_shared<Memory>(model);
  const CompactImpl& m = model.impl();
  Contest contest;
  const int joints = m.bodies() - 1, runs = static_cast<int>(m.runs.size()), types = static_cast<int>(m.batches.size());
  addOrder<PerBatch>(memory, "virtual_per_batch", types, runs, contest.contenders);
  addOrder<PerJointVirtual>(memory, "virtual_per_joint", joints, joints, contest.contenders);
  addOrder<PerJointVariant>(memory, "static_variant", joints, joints, contest.contenders);
  if (memory->scene.uniform) {
    addOrder<Monomorphic>(memory, "monomorphic", 0, 0, contest.contenders);
  } else {
    contest.missing = "monomorphic: the model has other joints than revolute ones below its root";
  }
  return contest;
}

}  // namespace dyn::benchmark
