// SPDX-License-Identifier: BSD-2-Clause
// The passes that order, remove and move bodies (order, weld, canonicalise), and the pass that inspects the result.
#include "at.hpp"
#include "compile/draft.hpp"

#include <algorithm>
#include <utility>

namespace dyn {

namespace {

/// Puts bodies into the order of `old_of_new` and renumbers every reference to them. Bodies that are not in it are dropped, so nothing may refer to
/// them.
void keepBodies(Draft& draft, const std::vector<int>& old_of_new) {
  std::vector<int> new_of_old(draft.bodies.size(), -1);
  std::vector<DraftBody> bodies;
  bodies.reserve(old_of_new.size());
  for (std::size_t i = 0; i < old_of_new.size(); ++i) {
    new_of_old[at(old_of_new[i])] = static_cast<int>(i);
    bodies.push_back(std::move(draft.bodies[at(old_of_new[i])]));
  }
  for (DraftBody& body : bodies)
    if (body.coupling) body.coupling->master = new_of_old[at(body.coupling->master)];
  draft.bodies = std::move(bodies);
}

}  // namespace

void orderDepthFirst(Draft& draft) {
  const std::size_t n = draft.bodies.size();
  const std::vector<Link> links_before = std::move(draft.skeleton.links);
  // Children stay in description order. A stack replaces recursion, because chains may be long.
  std::vector<std::vector<int>> children(n);
  for (std::size_t i = n - 1; i >= 1; --i) children[at(links_before[i].parent)].push_back(static_cast<int>(i));
  std::vector<int> order, stack{0};
  order.reserve(n);
  while (!stack.empty()) {
    const int i = stack.back();
    stack.pop_back();
    order.push_back(i);
    stack.insert(stack.end(), children[at(i)].begin(), children[at(i)].end());
  }
  std::vector<int> number(n);
  std::vector<Link> links;
  ExactInertias inertias;
  links.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    number[at(order[i])] = static_cast<int>(i);
    links.push_back(links_before[at(order[i])]);
    inertias.push_back(draft.inertias[at(order[i])]);
    links[i].parent = number[at(links[i].parent)];
  }
  draft.skeleton.links = std::move(links);
  draft.inertias = std::move(inertias);
  keepBodies(draft, order);
  // Every body is a frame of its own, in this order; the described extra frames follow.
  std::vector<LinkFrame> frames;
  std::vector<std::string> names;
  for (std::size_t i = 0; i < n; ++i) {
    if (i > 0 && !draft.bodies[i].last_part) continue;
    frames.push_back({static_cast<int>(i), {}});
    names.push_back(draft.bodies[i].name);
  }
  for (const LinkFrame& frame : draft.skeleton.frames) frames.push_back({number[at(frame.body)], frame.placement});
  names.insert(names.end(), draft.frame_names.begin(), draft.frame_names.end());
  draft.skeleton.frames = std::move(frames);
  draft.frame_names = std::move(names);
  notePass(draft.report, "order", "depth first, " + std::to_string(draft.skeleton.frames.size()) + " frames");
}

void weld(Draft& draft) {
  const std::size_t n = draft.bodies.size();
  weldLinks(draft.skeleton);
  keepBodies(draft, draft.skeleton.kept);
  notePass(draft.report, "weld",
           std::to_string(n - draft.bodies.size()) + " bodies welded to others, " + std::to_string(draft.bodies.size() - 1) + " move");
}

void canonicalise(Draft& draft) {
  turnLinks(draft.skeleton);
  draft.inertias = carriedInertias(draft.skeleton, draft.inertias);
  const std::vector<Origin> origins = originsOnAxes(draft.skeleton, draft.inertias);
  moveInertias(draft.inertias, origins);
  moveLinks(draft.skeleton.links, draft.skeleton.frames, origins);
  draft.described.origins = std::make_shared<const std::vector<Origin>>(origins);
  noteCanonical(draft.report, draft.skeleton, origins);
}

void inspect(Draft& draft) {
  const std::vector<bool> carries = carryInertia(draft.skeleton.links, draft.inertias);
  draft.described.first_massless = static_cast<int>(draft.report.warnings.size());
  for (std::size_t i = 1; i < draft.bodies.size(); ++i) {
    const DraftBody& body = draft.bodies[i];
    const bool armature = std::any_of(body.joint.armature.begin(), body.joint.armature.end(), [](double x) { return x > 0; });
    if (!carries[i] && !armature && !body.coupling) draft.report.warnings.push_back(masslessWarning(body.joint.name));
  }
  draft.described.massless = static_cast<int>(draft.report.warnings.size()) - draft.described.first_massless;
}

}  // namespace dyn
