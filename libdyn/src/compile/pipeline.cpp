// SPDX-License-Identifier: BSD-2-Clause
// The compiler's passes in their order.
#include "compile/constraints.hpp"
#include "compile/draft.hpp"

namespace dyn {

CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options) {
  const Model held = options.lock.empty() ? model : reduce(model, registry, options.lock);
  std::vector<std::string> left_out;
  const Model reduced = keepForScene(held, options.scene, left_out);
  Draft draft = resolve(reduced, registry);
  draft.report.passes.insert(draft.report.passes.begin(), left_out.begin(), left_out.end());
  orderDepthFirst(draft);
  keepDescribed(draft);
  weld(draft);
  canonicalise(draft);
  inspect(draft);
  passLimitsOn(draft);
  const std::shared_ptr<CompactImpl> compact = pack(std::move(draft), options);
  for (const BodyDescription& body : reduced.bodies)
    if (body.joint.held) compact->report.held.push_back(body.name);
  attachConstraints(compact, reduced.constraints, registry);
  return CompactModel(compact);
}

}  // namespace dyn
