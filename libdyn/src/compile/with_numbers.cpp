// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/constraints.hpp"
#include "compile/parameters.hpp"

#include <dyn/near_names.hpp>

#include <algorithm>
#include <string_view>
#include <unordered_map>

namespace dyn {

namespace {

/// Finds elements by name, in O(1) on average. Lists mostly have the order of the elements, so the one behind the last place is tried first.
template <class Elements, class NameOf>
class NameSearch {
 public:
  NameSearch(const Elements& elements, NameOf name_of) : elements_(elements), name_of_(name_of) {}
  /// Throws Error(argument) that begins with `what` if there is none.
  std::size_t operator()(const std::string& name, const std::string& what) {
    if (last_ + 1 < elements_.size() && name_of_(elements_[last_ + 1]) == name && !name.empty()) return ++last_;
    if (places_.empty())
      for (std::size_t i = 1; i < elements_.size(); ++i)
        if (!name_of_(elements_[i]).empty()) places_.emplace(name_of_(elements_[i]), i);
    const auto found = places_.find(name);
    if (found != places_.end()) return last_ = found->second;
    std::vector<std::string> names;
    for (std::size_t i = 1; i < elements_.size(); ++i)
      if (!name_of_(elements_[i]).empty()) names.push_back(name_of_(elements_[i]));
    throw Error(ErrorCode::argument, "withNumbers: " + what + " '" + name + "'" + nearNames(name, names));
  }

 private:
  const Elements& elements_;
  NameOf name_of_;
  std::size_t last_ = 0;
  std::unordered_map<std::string_view, std::size_t> places_;
};

/// The degrees of freedom of a joint that moves, dependent ones included.
struct Dofs {
  std::size_t first = 0, count = 0;
};
Dofs dofsOf(const CompactImpl& m, int joint) {
  int body = m.body_of_joint[at(joint)];
  const BodyIndex& last = m.index[at(body)];
  while (m.index[at(body - 1)].joint == joint) --body;
  return {at(m.index[at(body)].idx_v), at(last.idx_v + last.nv - m.index[at(body)].idx_v)};
}

void change(DescribedNumbers& out, const ModelNumbers& numbers) {
  const SharedVector<DescribedBody>& bodies = std::as_const(out).bodies;
  NameSearch body(bodies, [](const DescribedBody& x) -> const std::string& { return x.name; });
  NameSearch joint(bodies, [](const DescribedBody& x) -> const std::string& { return x.joint; });
  for (const BodyInertia& x : numbers.inertias) {
    const std::size_t i = body(x.body, "the model has no body");
    checkInertia(x.inertia, x.body, {});
    out.inertias[i] = x.inertia;
  }
  for (const JointPlacement& x : numbers.placements) {
    const std::size_t i = joint(x.joint, "the model has no joint");
    const Where where{"", 0, x.joint};
    checkPlacement(x.placement, "its placement", where);
    if (bodies[i].held)
      throw Error(ErrorCode::argument, "withNumbers: it is held, so that its place contains a pose of its motion; change the description", where);
    out.placements[i] = x.placement;
  }
  if (!numbers.placements.empty()) {
    const auto frames = out.skeleton->frames;
    out.skeleton = std::make_shared<LazySkeleton>();
    out.skeleton->frames = frames;
  }
}

void changeDissipation(CompactImpl& m, const char* name, SharedVector<double>& all, const std::vector<JointNumbers>& numbers) {
  const CompactImpl& model = m;
  NameSearch joint(model.joints, [](const JointRecord& record) -> const std::string& { return record.name; });
  for (const JointNumbers& x : numbers) {
    const Dofs dofs = dofsOf(model, static_cast<int>(joint(x.joint, std::string(name) + " is given for a joint that does not move:")));
    const Where where{"", 0, x.joint};
    checkDissipation(name, x.values, dofs.count, where);
    if (x.values.empty()) throw Error(ErrorCode::size, std::string(name) + " has no entries, the joint wants " + std::to_string(dofs.count), where);
    for (std::size_t k = 0; k < dofs.count; ++k) all[dofs.first + k] = x.values[k];
  }
}

/// Makes the skeleton of these placements, unless it exists.
const Skeleton& skeletonOf(const DescribedNumbers& described) {
  LazySkeleton& lazy = *described.skeleton;
  std::call_once(lazy.once, [&] {
    lazy.skeleton.links.resize(described.bodies.size());
    for (std::size_t i = 1; i < described.bodies.size(); ++i) {
      const DescribedBody& from = described.bodies[i];
      SE3<double> placement = described.placements[i];
      for (const SE3<double>& inner : from.inner) placement = placement * inner;
      lazy.skeleton.links[i] = {from.parent, from.shape, from.nv, cast<long double>(placement), from.before, from.after};
    }
    for (const DescribedFrame& frame : *lazy.frames) lazy.skeleton.frames.push_back({frame.body, cast<long double>(frame.placement)});
    weldLinks(lazy.skeleton);
    turnLinks(lazy.skeleton);
  });
  return lazy.skeleton;
}

/// Writes the warnings of joints that move no mass.
void warnOfMassless(CompactImpl& out, const Skeleton& skeleton, const ExactInertias& inertias) {
  const CompactImpl& m = out;
  const std::vector<bool> carries = carryInertia(skeleton.links, inertias);
  std::vector<std::string> massless;
  for (std::size_t i = 1; i < carries.size(); ++i) {
    if (carries[i]) continue;
    const DescribedBody& body = m.described.bodies[at(skeleton.kept[i])];
    const double* armature = m.described.armature.data() + m.index[i].idx_v;
    if (!body.coupled && std::none_of(armature, armature + m.index[i].nv, [](double number) { return number > 0; }))
      massless.push_back(masslessWarning(body.part));
  }
  std::vector<std::string>& warnings = out.report.warnings;
  const auto first = warnings.begin() + m.described.first_massless, end = first + m.described.massless;
  warnings.insert(warnings.erase(first, end), massless.begin(), massless.end());
  out.described.massless = static_cast<int>(massless.size());
}

/// Composes the numbers of the compact model from those of the description, as compile() does.
void compose(CompactImpl& out, bool placements_changed) {
  const DescribedNumbers& described = std::as_const(out).described;
  const Skeleton& skeleton = skeletonOf(described);
  ExactInertias inertias(described.bodies.size());
  for (std::size_t i = 1; i < inertias.size(); ++i) inertias[i] = cast<long double>(described.inertias[i]);
  inertias = carriedInertias(skeleton, inertias);
  const std::vector<Origin> origins = originsOnAxes(skeleton, inertias);
  moveInertias(inertias, origins);
  if (placements_changed || origins != *described.origins) {
    std::vector<Link> links = skeleton.links;
    std::vector<LinkFrame> frames = skeleton.frames;
    moveLinks(links, frames, origins);
    writePlacements(out, links, frames);
    out.described.origins = std::make_shared<const std::vector<Origin>>(origins);
    noteCanonical(out.report, skeleton, origins);
  }
  writeInertias(out, inertias);
  warnOfMassless(out, skeleton, inertias);
}

}  // namespace

CompactModel CompactModel::withNumbers(const ModelNumbers& numbers) const {
  const auto out = std::make_shared<CompactImpl>(*impl_);
  if (numbers.gravity) {
    checkGravity(*numbers.gravity);
    out->gravity = *numbers.gravity;
  }
  change(out->described, numbers);
  changeDissipation(*out, "damping", out->described.damping, numbers.damping);
  changeDissipation(*out, "friction", out->described.friction, numbers.friction);
  changeDissipation(*out, "armature", out->described.armature, numbers.armature);
  writeDissipation(*out);
  // Armature decides about warnings.
  if (!numbers.inertias.empty() || !numbers.placements.empty() || !numbers.armature.empty()) compose(*out, !numbers.placements.empty());
  if (std::as_const(*out).lane_groups.uses.rnea) writeLaneNumbers(out->lane_groups, *out);
  out->constraints = withPlacedFrames(*out, std::as_const(*impl_).frame_placement);
  return CompactModel(out);
}

ModelNumbers CompactModel::numbers() const {
  const CompactImpl& m = *impl_;
  const DescribedNumbers& described = m.described;
  ModelNumbers out;
  out.gravity = m.gravity;
  for (std::size_t i = 1; i < described.bodies.size(); ++i) {
    const DescribedBody& body = described.bodies[i];
    if (!body.name.empty()) out.inertias.push_back({body.name, described.inertias[i]});
    if (!body.joint.empty() && !body.held) out.placements.push_back({body.joint, described.placements[i]});
  }
  for (int j = 1; j < njoints(); ++j) {
    const Dofs dofs = dofsOf(m, j);
    const auto add = [&](std::vector<JointNumbers>& to, const SharedVector<double>& all) {
      to.push_back({m.joints[at(j)].name, {all.data() + dofs.first, all.data() + dofs.first + dofs.count}});
    };
    add(out.damping, described.damping);
    add(out.friction, described.friction);
    add(out.armature, described.armature);
  }
  return out;
}

}  // namespace dyn
