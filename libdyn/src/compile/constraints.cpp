// SPDX-License-Identifier: BSD-2-Clause
#include "compile/constraints.hpp"

#include "at.hpp"
#include "compile/parameters.hpp"

#include <dyn/near_names.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace dyn {

namespace {

/// Writes the poses of a constraint's frames in their bodies, and the directions of its rows.
void place(PackedFrameConstraint& p, const FrameConstraint& c, const CompactImpl& m) {
  const SE3<double>* placements[2] = {&c.placement, &c.other_placement};
  for (int e = 0; e < 2; ++e) p.placement[e] = cast<double>(cast<long double>(m.frame_placement[at(p.frame[e])]) * cast<long double>(*placements[e]));
  p.own_axes = Mat3<double>::identity();
  if (p.axes == ConstraintAxes::LOCAL) p.own_axes = p.placement[0].R;
  if (p.axes == ConstraintAxes::OTHER) p.own_axes = p.placement[1].R;
  p.linear_rows = static_cast<int>(std::count(p.free.begin(), p.free.begin() + 3, false));
  eachDirection(p, [&](int row, int direction) {
    const int k = row - p.row;
    for (int a = 0; a < 3; ++a) (direction < 3 ? p.linear[a][k] : p.angular[a][k - p.linear_rows]) = p.own_axes(a, direction % 3);
  });
}

class ConstraintPacker {
 public:
  ConstraintPacker(const CompactModel& model, const JointRegistry* registry) : model_(model), m_(model.impl()), registry_(registry) {}

  PackedConstraints run(const std::vector<ConstraintDescription>& descriptions, const PackedConstraints* base) {
    std::set<std::string> names;
    if (base) {
      goOnFrom(*base);
      for (const ConstraintDescription& d : base->descriptions) names.insert(d.name);
    }
    out_.descriptions.insert(out_.descriptions.end(), descriptions.begin(), descriptions.end());
    for (const ConstraintDescription& d : descriptions) {
      current_ = &d;
      if (!names.insert(d.name).second)
        refuse("there are two constraints of that name; a contact stands in a set once, others need names of their own");
      for (const double gain : {d.baumgarte.position, d.baumgarte.velocity})
        if (!(gain >= 0) || !std::isfinite(gain)) refuse("a Baumgarte gain is negative or no number");
      out_.first_row.push_back(out_.rows);
      std::visit([&](const auto& relation) { pack(relation); }, d.relation);
    }
    out_.first_row.push_back(out_.rows);
    listBodies();
    return std::move(out_);
  }

 private:
  void goOnFrom(const PackedConstraints& base) {
    out_.descriptions = base.descriptions;
    out_.first_row.assign(base.first_row.begin(), base.first_row.end() - 1);
    out_.frames = base.frames;
    out_.couplings = base.couplings;
    out_.locks = base.locks;
    out_.rows = base.rows;
  }

  [[noreturn]] void refuse(const std::string& why, ErrorCode code = ErrorCode::model) const {
    throw Error(code, "constraint '" + current_->name + "': " + why, current_->where);
  }

  int frame(const std::string& name) const {
    const int id = model_.findFrame(name);
    if (id < 0) refuse("the model has no body or frame '" + name + "'" + nearNames(name, namesOf(model_.frames())));
    return id;
  }
  int joint(const std::string& name) const {
    const int id = model_.findJoint(name);
    if (id <= 0) refuse("the model has no moving joint '" + name + "'" + nearNames(name, namesOf(model_.joints())));
    return id;
  }
  int takeRows(int count) {
    out_.rows += count;
    return out_.rows - count;
  }

  void pack(const FrameConstraint& c) {
    PackedFrameConstraint p;
    const int ids[2] = {frame(c.frame), frame(c.other)};
    const SE3<double>* placements[2] = {&c.placement, &c.other_placement};
    for (int e = 0; e < 2; ++e) {
      p.body[e] = m_.frame_body[at(ids[e])];
      p.frame[e] = ids[e];
      for (int k = 0; k < 12; ++k)
        if (!std::isfinite(k < 9 ? placements[e]->R.m[k] : placements[e]->p[k - 9])) refuse("its placement has an entry that is not finite");
    }
    if (p.body[0] == p.body[1]) refuse("'" + c.frame + "' and '" + c.other + "' belong to one body" + (p.body[0] == 0 ? ", the world" : ""));
    // Bodies are numbered depth first, so the body with the larger number is not above the other.
    int a = p.body[0], b = p.body[1];
    while (a != b) (a > b ? a : b) = m_.index[at(std::max(a, b))].parent;
    p.common = a;
    listSlots(p);
    const auto rotations = std::count(c.free.begin() + 3, c.free.end(), true);
    if (c.has_target && rotations == 2)
      refuse("two rotations are free: as a joint that has no angle to keep; free one (a hinge), all (a ball), or cut the mechanism elsewhere");
    if (c.has_target && rotations == 1 && c.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED)
      refuse(
          "one rotation is free about an axis of the world: a hinge that is kept in its place has its axis in one of its bodies; use LOCAL or OTHER");
    p.rows = static_cast<int>(std::count(c.free.begin(), c.free.end(), false));
    if (p.rows == 0) refuse("all directions are free");
    p.row = takeRows(p.rows);
    p.free = c.free;
    p.axes = c.axes;
    place(p, c, m_);
    p.has_target = c.has_target;
    p.baumgarte = current_->baumgarte;
    if (p.baumgarte.position > 0 && !p.has_target) refuse("it has a gain on an error of position, but no place to be at (has_target)");
    out_.frames.push_back(std::move(p));
  }

  void listSlots(PackedFrameConstraint& p) const {
    std::map<int, PackedFrameConstraint::Slot> slots;
    const auto list = [&](const BodyIndex& x) {
      for (int k = 0; k < x.nv; ++k) slots.insert({x.idx_v + k, {x.idx_v + k, x.user_v < 0 ? -1 : x.user_v + k}});
    };
    for (const int end : p.body)
      for (int i = end; i > 0; i = m_.index[at(i)].parent) list(m_.index[at(i)]);
    // Couplings of dependent joints come after those of their masters.
    for (auto coupling = m_.couplings.rbegin(); coupling != m_.couplings.rend(); ++coupling)
      if (slots.count(m_.index[at(coupling->body)].idx_v) > 0) list(m_.index[at(coupling->master)]);
    for (const auto& [dof, slot] : slots) p.slots.push_back(slot);
    for (int e = 0; e < 2; ++e)
      for (int i = p.body[e]; i > 0; i = m_.index[at(i)].parent)
        for (int k = 0; k < m_.index[at(i)].nv; ++k)
          p.path[e].push_back(static_cast<int>(std::distance(slots.begin(), slots.find(m_.index[at(i)].idx_v + k))));
  }

  void pack(const JointCoupling& c) {
    if (registry_ == nullptr) refuse("couplings are looked up in a registry, and none was given", ErrorCode::argument);
    PackedJointCoupling p;
    p.body = single(joint(c.joint));
    p.master = single(joint(c.coupling.master));
    if (p.body == p.master) refuse("a joint cannot follow itself");
    std::tie(p.type, p.constants) = prepareCoupling(c.coupling, *registry_, current_->where);
    p.row = takeRows(1);
    p.baumgarte = current_->baumgarte;
    out_.couplings.push_back(std::move(p));
  }

  /// The body of a joint that has one degree of freedom of its own. Refuses other joints.
  int single(int id) const {
    const JointRecord& record = model_.joints()[at(id)];
    if (record.nv != 1)
      refuse("joint '" + record.name + "' has " + std::to_string(record.nv) + " degrees of freedom of its own; couplings are for one");
    int body = m_.body_of_joint[at(id)];
    while (m_.index[at(body)].user_v < 0 && m_.index[at(body - 1)].joint == id) --body;
    return body;
  }

  void pack(const JointLock& c) {
    const int id = joint(c.joint);
    const JointRecord& record = model_.joints()[at(id)];
    if (record.nv == 0) refuse("joint '" + c.joint + "' follows another and has no freedom of its own");
    if (!c.configuration.empty() && c.configuration.size() != at(record.nq))
      refuse("it needs " + std::to_string(record.nq) + " coordinates, it was given " + std::to_string(c.configuration.size()), ErrorCode::size);
    if (current_->baumgarte.position > 0 && c.configuration.empty()) refuse("it has a gain on an error of position, but no configuration to be at");
    for (int body = 1; body < m_.bodies(); ++body) {
      const BodyIndex& x = m_.index[at(body)];
      if (x.joint != id || x.user_v < 0) continue;
      PackedJointLock p;
      p.body = body;
      p.rows = x.nv;
      p.row = takeRows(x.nv);
      p.baumgarte = current_->baumgarte;
      if (!c.configuration.empty()) {
        const auto first = c.configuration.begin() + (x.user_q - record.idx_q);
        p.configuration.assign(first, first + x.nq);
      }
      out_.locks.push_back(std::move(p));
    }
  }

  /// Lists every body on a path from a constraint to the world, and the rows that act on its subtree.
  void listBodies() {
    struct Acting {
      int begin = std::numeric_limits<int>::max(), end = 0;
      bool here = false;  ///< rows act on the body itself
      int children = 0;   ///< children on whose subtrees rows act
    };
    std::vector<Acting> acting(m_.index.size());
    const auto acts = [&](int body, int row, int rows) {
      acting[at(body)].here = true;
      for (; body > 0; body = m_.index[at(body)].parent) {
        Acting& x = acting[at(body)];
        if (x.end == 0) ++acting[at(m_.index[at(body)].parent)].children;
        x.begin = std::min(x.begin, row);
        x.end = std::max(x.end, row + rows);
      }
    };
    for (const auto& c : out_.frames)
      for (const int body : c.body) acts(body, c.row, c.rows);
    for (const auto& c : out_.couplings)
      for (const int body : {c.body, c.master}) acts(body, c.row, 1);
    for (const auto& c : out_.locks) acts(c.body, c.row, c.rows);
    out_.body_at.assign(m_.index.size(), -1);
    for (int i = m_.bodies() - 1; i > 0; --i) {
      const Acting& x = acting[at(i)];
      if (x.end == 0) continue;
      const int place = static_cast<int>(out_.bodies.size()), dof = static_cast<int>(out_.dofs.size());
      // Subtrees are contiguous, so an only child is the body listed before.
      if (x.here || x.children != 1) out_.chains.push_back({place, place, dof, dof, x.begin, x.end});
      out_.body_at[at(i)] = place;
      out_.bodies.push_back(
          {i, static_cast<int>(out_.chains.size()) - 1, dof, m_.lane_groups.uses.rnea ? m_.lane_groups.lane_slots[at(i)] : LaneSlot{}});
      for (int k = 0; k < m_.index[at(i)].nv; ++k) out_.dofs.push_back(m_.index[at(i)].idx_v + k);
      out_.chains.back().end = static_cast<int>(out_.bodies.size());
      out_.chains.back().dof_end = static_cast<int>(out_.dofs.size());
    }
    for (ConstrainedChain& chain : out_.chains) {
      const int parent = out_.body_at[at(m_.index[at(out_.bodies[at(chain.end - 1)].body)].parent)];
      if (parent >= 0) chain.parent = out_.bodies[at(parent)].chain;
    }
    listLaneGroupDofs();
    for (const PackedFrameConstraint& c : out_.frames) out_.drift_with_velocity |= c.driftsWithVelocity();
    for (ConstrainedChain& chain : out_.chains) {
      const auto meets = [&](int row, int end) { return row < chain.row_end && end > chain.row_begin; };
      for (const ConstrainedChain& other : out_.chains)
        if (&other != &chain && other.parent == chain.parent && meets(other.row_begin, other.row_end)) chain.alone = false;
      for (const auto& c : out_.frames)
        for (const int body : c.body)
          if (body > 0 && out_.chainOf(body) == chain.parent && meets(c.row, c.row + c.rows)) chain.alone = false;
      if (!chain.alone) (chain.parent < 0 ? out_.gathers : out_.chains[at(chain.parent)].gathers) = true;
    }
  }

  void listLaneGroupDofs() {
    if (!m_.lane_groups.uses.rnea) return;
    std::vector<ConstrainedLaneGroupDof> all(at(m_.lane_groups.dofs));
    for (const ConstrainedBody& body : out_.bodies)
      for (int k = 0; k < m_.index[at(body.body)].nv; ++k) {
        ConstrainedLaneGroupDof& x = all[at(body.lane_slot.group_dof + k)];
        x.group_dof = body.lane_slot.group_dof + k;
        x.lanes |= body.lane_slot.lanes;
        for (int l = 0; l < group_lanes; ++l)
          if ((body.lane_slot.lanes >> l & 1) != 0) x.dofs[l] = body.dof + k;
      }
    for (const ConstrainedLaneGroupDof& x : all)
      if (x.lanes != 0) out_.group_dofs.push_back(x);
  }

  const CompactModel& model_;
  const CompactImpl& m_;
  const JointRegistry* registry_;
  const ConstraintDescription* current_ = nullptr;
  PackedConstraints out_;
};

}  // namespace

PackedConstraints packConstraints(const CompactModel& model, const std::vector<ConstraintDescription>& descriptions, const JointRegistry* registry,
                                  const PackedConstraints* base) {
  return ConstraintPacker(model, registry).run(descriptions, base);
}

std::shared_ptr<const PackedConstraints> withPlacedFrames(const CompactImpl& m, const SharedVector<SE3<double>>& before) {
  if (m.constraints->frames.empty() || m.frame_placement.data() == before.data()) return m.constraints;
  const auto out = std::make_shared<PackedConstraints>(*m.constraints);
  auto frame = out->frames.begin();
  for (const ConstraintDescription& description : out->descriptions)
    if (const auto* relation = std::get_if<FrameConstraint>(&description.relation)) place(*frame++, *relation, m);
  return out;
}

void attachConstraints(const std::shared_ptr<CompactImpl>& compact, const std::vector<ConstraintDescription>& descriptions,
                       const JointRegistry& registry) {
  // Names are looked up through a model that does not own `compact`, because the constraints become a part of it.
  const CompactModel seen(std::shared_ptr<const CompactImpl>(compact.get(), [](const CompactImpl*) {}));
  compact->constraints = std::make_shared<PackedConstraints>(packConstraints(seen, descriptions, &registry));
  if (!descriptions.empty())
    compact->report.passes.push_back("constraints: " + std::to_string(descriptions.size()) + ", of " + std::to_string(compact->constraints->rows) +
                                     " rows");
}

}  // namespace dyn
