// The list of passes: the compiler's table of contents.
#include "compile/constraints.hpp"
#include "compile/draft.hpp"

namespace dyn {

CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options) {
  const Model reduced = options.lock.empty() ? model : reduce(model, registry, options.lock);
  Draft draft = resolve(reduced, registry);
  orderDepthFirst(draft);
  weld(draft);
  canonicalise(draft);
  inspect(draft);
  const std::shared_ptr<CompactImpl> compact = pack(std::move(draft), options);
  attachConstraints(compact, reduced.constraints, registry);
  return CompactModel(compact);
}

}  // namespace dyn
