// The list of passes: the compiler's table of contents.
#include "compile/draft.hpp"

namespace dyn {

CompactModel compile(const Model& model, const JointRegistry& registry, const CompileOptions& options) {
  Draft draft = resolve(model, registry);
  orderDepthFirst(draft);
  lockJoints(draft, options.lock);
  weld(draft);
  canonicalise(draft);
  inspect(draft);
  return CompactModel(pack(std::move(draft), options));
}

}  // namespace dyn
