#include "dispatch/contest.hpp"

namespace dyn::benchmark {

Contest dispatchContest(const CompactModel& model) {
  const auto memory = std::make_shared<Memory>(model);
  Contest contest;
  addVirtualDispatch(memory, contest.contenders);
  addStaticDispatch(memory, contest.contenders);
  if (!memory->scene.uniform) contest.missing = "monomorphic: the model has other joints than revolute ones below its root";
  return contest;
}

}  // namespace dyn::benchmark
