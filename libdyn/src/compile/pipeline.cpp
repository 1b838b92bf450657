// The list of passes: the compiler's table of contents.
#include "compile/draft.hpp"

namespace dyn {

CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options) {
  Draft draft = resolve(options.lock.empty() ? model : reduce(model, registry, options.lock), registry);
  orderDepthFirst(draft);
  weld(draft);
  canonicalise(draft);
  inspect(draft);
  return CompactModel(pack(std::move(draft), options));
}

}  // namespace dyn
