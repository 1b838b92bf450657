// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/compact_impl.hpp"
#include "compile/draft.hpp"
#include "same_bits.hpp"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

namespace dyn {

namespace {

/// R as an AxisExchange, if it only exchanges axes, exact to the last bit.
AxisExchange exchangeOf(const Mat3<double>& R) {
  for (std::int8_t shift = 0; shift < 3; ++shift)
    for (const bool flips : {false, true}) {
      bool exact = true;
      for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k) exact = exact && R(i, k) == (i == (k + shift) % 3 ? (flips && k > 0 ? -1 : 1) : 0);
      if (exact) return {shift, flips};
    }
  return {};
}

/// BodyIndex::offset_axes of a joint that does not move the origin.
std::uint8_t offsetOf(const Vec3<double>& p) { return static_cast<std::uint8_t>((p.x != 0) | (p.y != 0) << 1 | (p.z != 0) << 2); }

/// Writes `value` to a member of an element, unless it is there already: writing would end the sharing.
template <class T, class Member, class Value>
void put(SharedVector<T>& vector, std::size_t i, const Member& member, const Value& value) {
  if (!sameBits(member(std::as_const(vector)[i]), value)) const_cast<Value&>(member(vector[i])) = value;
}
template <class Value>
void put(SharedVector<Value>& vector, std::size_t i, const Value& value) {
  put(
      vector, i, [](const Value& x) -> const Value& { return x; }, value);
}

}  // namespace

InertiaConstants<double> inertiaConstants(const Inertia<long double>& inertia) {
  const Inertia<double> Y = cast<double>(inertia);
  const Inertia<double> about = cast<double>(Inertia<long double>{inertia.mass, inertia.mass * inertia.com, inertia.rotationalAtOrigin()});
  return {Y.mass, Y.com, Y.rotational, about.com, about.rotational};
}

void writePlacements(CompactImpl& out, const std::vector<Link>& links, const std::vector<LinkFrame>& frames) {
  const CompactImpl& m = out;
  out.constants.resize(links.size());
  for (std::size_t i = 1; i < links.size(); ++i) {
    const SE3<double> placement = out.constants[i].placement = cast<double>(links[i].placement);
    put(
        out.index, i, [](const BodyIndex& x) -> const AxisExchange& { return x.exchange; }, exchangeOf(placement.R));
    put(
        out.index, i, [](const BodyIndex& x) -> const std::uint8_t& { return x.offset_axes; },
        m.index[i].turns_only ? offsetOf(placement.p) : std::uint8_t(7));
    // The last part of a joint has the frame of the described body.
    if (m.body_of_joint[at(m.index[i].joint)] == static_cast<int>(i)) put(out.user_frame, at(m.index[i].joint), links[i].after);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const SE3<long double> joint = cast<long double>(m.user_frame[at(m.frames[k].joint)]);
    put(out.frame_placement, k, cast<double>(frames[k].placement));
    put(
        out.frames, k, [](const FrameRecord& x) -> const SE3<double>& { return x.placement; }, cast<double>(joint.inverse() * frames[k].placement));
  }
}

void writeInertias(CompactImpl& out, const ExactInertias& inertias) {
  out.constants_float.resize(inertias.size());
  out.constants_float[0] = broadcast<float>(out.constants[0]);
  out.mass = 0;
  for (std::size_t i = 1; i < inertias.size(); ++i) {
    const InertiaConstants<double> x = inertiaConstants(inertias[i]);
    BodyConstants<double>& c = out.constants[i];
    c = {c.placement, x.mass, x.com, x.rotational, x.h, x.origin};
    out.constants_float[i] = broadcast<float>(c);
    out.mass += c.mass;
  }
}

void writeDissipation(CompactImpl& out) {
  const DescribedNumbers& described = out.described;
  const auto acting = [](bool acts, const SharedVector<double>& x) {
    const bool any = acts && std::any_of(x.begin(), x.end(), [](double number) { return number != 0; });
    return any ? x.vector() : std::vector<double>();
  };
  out.damping = acting(described.dissipation_acts, described.damping);
  out.friction = acting(described.dissipation_acts, described.friction);
  out.armature = acting(described.armature_acts, described.armature);
  out.roots_have_armature = false;
  for (std::size_t k = 0; k < out.armature.size(); ++k)
    out.roots_have_armature |= out.armature[k] != 0 && std::as_const(out.index)[at(std::as_const(out.dof_body)[k])].floating_base;
  const auto used = [](const std::vector<double>& values) { return values.empty() ? "none" : "used"; };
  notePass(out.report, "dissipation",
           std::string("damping ") + used(out.damping) + ", friction " + used(out.friction) + ", armature " + used(out.armature));
}

void keepDescribed(Draft& draft) {
  std::vector<DescribedBody> bodies(draft.bodies.size());
  std::vector<Inertia<double>> inertias(bodies.size());
  std::vector<SE3<double>> placements(bodies.size());
  for (std::size_t i = 1; i < bodies.size(); ++i) {
    const DraftBody& from = draft.bodies[i];
    const Link& link = draft.skeleton.links[i];
    if (from.last_part) bodies[i].name = from.name;
    if (from.first_part) bodies[i].joint = from.user_name;
    bodies[i].part = from.joint.name;
    bodies[i].parent = link.parent;
    bodies[i].shape = link.shape;
    bodies[i].nv = link.nv;
    bodies[i].before = link.before;
    bodies[i].after = link.after;
    bodies[i].inner = from.inner;
    bodies[i].held = from.held;
    bodies[i].coupled = from.coupling.has_value();
    inertias[i] = cast<double>(draft.inertias[i]);
    placements[i] = from.first_part ? from.user_placement : cast<double>(link.placement);
  }
  auto frames = std::make_shared<std::vector<DescribedFrame>>();
  for (const LinkFrame& frame : draft.skeleton.frames) frames->push_back({frame.body, cast<double>(frame.placement)});
  draft.described.bodies = SharedVector(std::move(bodies));
  draft.described.inertias = SharedVector(std::move(inertias));
  draft.described.placements = SharedVector(std::move(placements));
  draft.described.skeleton = std::make_shared<LazySkeleton>();
  draft.described.skeleton->frames = std::move(frames);
}

void notePass(CompileReport& report, const std::string& pass, const std::string& text) {
  const std::string line = pass + ": " + text;
  const auto known = std::find_if(report.passes.begin(), report.passes.end(),
                                  [&](const std::string& x) { return x.compare(0, pass.size() + 2, line, 0, pass.size() + 2) == 0; });
  if (known == report.passes.end()) {
    report.passes.push_back(line);
  } else {
    *known = line;
  }
}

void noteCanonical(CompileReport& report, const Skeleton& skeleton, const std::vector<Origin>& origins) {
  const auto met = std::count_if(origins.begin(), origins.end(), [](const Origin& origin) { return origin.met; });
  notePass(report, "canonicalise",
           std::to_string(skeleton.turned) + " joint axes turned onto z, " + std::to_string(skeleton.along) + " along axes of their parents, " +
               std::to_string(met) + " origins where they cross");
}

std::string masslessWarning(const std::string& joint) {
  return "joint '" + joint + "' moves nothing that has mass: the mass matrix is singular, forward dynamics will refuse";
}

}  // namespace dyn
