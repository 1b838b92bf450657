// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/compact_impl.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <utility>

namespace dyn {

PackMemory::PackMemory(std::size_t bytes) : bytes_(bytes + alignment), block_(new char[bytes + alignment]) {
  std::memset(block_.get(), 0, bytes_);
  const auto address = reinterpret_cast<std::uintptr_t>(block_.get());
  data_ = block_.get() + (alignment - address % alignment) % alignment;
}

PackMemory::PackMemory(const PackMemory& other) : PackMemory(other.bytes_ - alignment) { std::copy_n(other.data_, bytes_ - alignment, data_); }

namespace {

/// Whether the tree branches at a mirrored body. It does unless its only child is mirrored in the same lanes.
bool parts(const LaneGroupPlan& plan, const CompactImpl& m, int body) {
  const LaneSlot& lane_slot = plan.lane_slots[at(body)];
  if (body == 0 || lane_slot.lanes == 1U << lane_slot.lane) return false;
  const int child = body + 1;
  return m.tree_end[at(child)] != m.tree_end[at(body)] || plan.lane_slots[at(child)].lanes != lane_slot.lanes;
}

class Planner {
 public:
  explicit Planner(const CompactImpl& m) : m_(m), height_(at(m.bodies()), 1), leaves_(at(m.bodies()), 0) {
    plan_.lane_groups.emplace_back();
    plan_.lane_slots.resize(at(m.bodies()));
    plan_.lane_slots[0].lanes = (1U << group_lanes) - 1;
    for (int i = m.bodies() - 1; i > 0; --i) {
      if (leaves_[at(i)] == 0) leaves_[at(i)] = 1;
      leaves_[at(parentOf(i))] += leaves_[at(i)];
      height_[at(parentOf(i))] = std::max(height_[at(parentOf(i))], height_[at(i)] + 1);
    }
  }

  LaneGroupPlan assigned() {
    assignAll();
    return std::move(plan_);
  }
  LaneGroupPlan run(const std::string& instruction_set) {
    assignAll();
    plan_.count = static_cast<int>(plan_.lane_groups.size()) - 1;
    findRootPaths();
    judge(instruction_set);
    if (!plan_.uses.rnea) {
      plan_.lane_groups = {};
      plan_.lane_slots = {};
      return std::move(plan_);
    }
    family();
    runs();
    batches();
    dofs();
    writeLaneNumbers(plan_, m_);
    return std::move(plan_);
  }

 private:
  const BodyIndex& index(int body) const { return m_.index[at(body)]; }
  int parentOf(int body) const { return index(body).parent; }
  /// Bodies with the longest path to a leaf come first.
  using Rank = std::pair<int, int>;
  Rank rank(int body) const { return {-height_[at(body)], body}; }
  /// The type batch, and whether the body is a root. Roots have no parents to gather from, so they share no lane groups with other bodies.
  using Kind = std::pair<int, bool>;
  Kind kindOf(int body) const { return {index(body).batch, parentOf(body) == 0}; }
  /// The lane group and lane of the parent, and the type batch.
  std::array<int, 3> childrenOf(int body) const {
    const LaneSlot& parent = plan_.lane_slots[at(parentOf(body))];
    return {parent.group, parent.lane, index(body).batch};
  }

  /// Makes one lane group after the other. Children of the last one come first, and among bodies those with the longest path to a leaf.
  void assignAll() {
    open(0);
    while (!waiting_.empty()) {
      const LaneGroup group = fill(leader());
      for (const int body : group.body)
        if (body >= 0) close(body);
      add(group);
      for (const int body : group.body)
        if (body >= 0) open(body);
    }
  }

  /// The children of a body that has its lane slot now wait for theirs.
  void open(int parent) {
    for (int i = parent + 1; i < m_.tree_end[at(parent)]; i = m_.tree_end[at(i)]) {
      children_[childrenOf(i)].insert(rank(i));
      waiting_[kindOf(i)].insert(rank(i));
    }
  }
  void close(int body) {
    const auto leave = [&](auto& sets, const auto& key) {
      const auto set = sets.find(key);
      set->second.erase(rank(body));
      if (set->second.empty()) sets.erase(set);
    };
    leave(children_, childrenOf(body));
    leave(waiting_, kindOf(body));
  }

  int leader() const {
    Rank best{0, 0};
    const int last = static_cast<int>(plan_.lane_groups.size()) - 1;
    for (auto set = children_.lower_bound({last, 0, 0}); set != children_.end(); ++set) best = std::min(best, *set->second.begin());
    if (best.second == 0)
      for (const auto& [kind, bodies] : waiting_) best = std::min(best, *bodies.begin());
    return best.second;
  }

  /// Makes a lane group of this body and others of its kind: first those that fit into a lane of their parents, then any. If lanes are left, bodies
  /// that carry several limbs are mirrored in more of their parents' lanes.
  LaneGroup fill(int leader) const {
    LaneGroup group;
    group.batch = index(leader).batch;
    const int family = plan_.lane_slots[at(parentOf(leader))].group;
    const LaneGroup& above = plan_.lane_groups[at(family)];
    std::set<Rank> homeless;
    for (int lane = 0; lane < group_lanes; ++lane) {
      const auto set = children_.find({family, lane, group.batch});
      if (set == children_.end()) continue;
      auto body = set->second.begin();
      for (int l = 0; l < group_lanes && body != set->second.end(); ++l)
        if (above.shows[l] == above.body[lane]) group.body[l] = (body++)->second;
      for (int k = 0; k < group_lanes && body != set->second.end(); ++k, ++body) homeless.insert(*body);
    }
    const auto sit = [&](int body) {
      int* lane_slot = std::find(group.body, group.body + group_lanes, -1);
      if (lane_slot == group.body + group_lanes) return false;
      if (std::find(group.body, group.body + group_lanes, body) == group.body + group_lanes) *lane_slot = body;
      return true;
    };
    for (const std::set<Rank>* bodies : {&std::as_const(homeless), &waiting_.at(kindOf(leader))})
      for (const Rank& body : *bodies)
        if (!sit(body.second)) break;
    mirror(group);
    return group;
  }

  void mirror(LaneGroup& group) const {
    int limbs[group_lanes] = {};
    for (int l = 0; l < group_lanes; ++l) {
      group.shows[l] = group.body[l];
      if (group.body[l] >= 0) limbs[l] = leaves_[at(group.body[l])] - 1;
    }
    for (int l = 0; l < group_lanes; ++l) {
      if (group.body[l] >= 0) continue;
      int most = -1;
      for (int other = 0; other < group_lanes; ++other)
        if (limbs[other] > 0 && (most < 0 || limbs[other] > limbs[most]) && hasLane(parentOf(group.body[other]), l)) most = other;
      if (most < 0) continue;
      group.shows[l] = group.body[most];
      --limbs[most];
    }
  }
  /// Whether the body is in this lane of its lane group, or mirrored there.
  bool hasLane(int body, int lane) const { return (plan_.lane_slots[at(body)].lanes >> lane & 1) != 0; }

  void add(LaneGroup group) {
    const TypeBatch& batch = m_.batches[at(group.batch)];
    group.shape = batch.shape;
    group.nv = batch.nv;
    group.dof = plan_.dofs;
    plan_.dofs += batch.nv;
    const int number = static_cast<int>(plan_.lane_groups.size());
    for (int l = 0; l < group_lanes; ++l) {
      const int body = group.shows[l];
      if (body < 0) continue;
      const BodyIndex& x = index(body);
      const unsigned same = lanesOf(group.shows, [&](int other) { return other == body; });
      if (group.body[l] >= 0) {
        group.depth = std::max(group.depth, x.depth);
        plan_.lane_slots[at(body)] = {number, l, same, group.dof};
      }
      const LaneSlot& parent = plan_.lane_slots[at(x.parent)];
      const bool alone = lanesOf(group.shows, [&](int other) { return other >= 0 && parentOf(other) == x.parent; }) == same;
      join(group, {parent.group, hasLane(x.parent, l) && (alone || parent.lanes != 1U << parent.lane) ? -1 : parent.lane, 1U << l});
    }
    group.same_lanes = group.parents_count == 1 && group.parents[0].lane < 0;
    plan_.lane_groups.push_back(group);
  }
  template <class Lanes, class Test>
  static unsigned lanesOf(const Lanes& all, Test&& test) {
    unsigned lanes = 0;
    for (int l = 0; l < group_lanes; ++l)
      if (test(all[static_cast<std::size_t>(l)])) lanes |= 1U << l;
    return lanes;
  }

  static void join(LaneGroup& group, const LaneGroupParents& parents) {
    for (int i = 0; i < group.parents_count; ++i) {
      LaneGroupParents& known = group.parents[i];
      if (known.group != parents.group || known.lane != parents.lane) continue;
      known.lanes |= parents.lanes;
      return;
    }
    group.parents[group.parents_count++] = parents;
  }

  void family() {
    for (std::size_t s = plan_.lane_groups.size(); s-- > 1;) {
      LaneGroup& group = plan_.lane_groups[s];
      int unions = 0;
      for (const int body : group.body)
        if (body >= 0 && parts(plan_, m_, body)) group.united[unions++] = plan_.lane_slots[at(body)].lanes;
      for (int p = 0; p < group.parents_count; ++p) {
        LaneGroupParents& parents = group.parents[p];
        for (int l = 0; l < group_lanes; ++l) {
          if ((parents.lanes >> l & 1) == 0) continue;
          const int body = group.shows[l], parent = parentOf(body);
          const bool along_trunk = !parts(plan_, m_, parent) && plan_.lane_slots[at(parent)].lanes == plan_.lane_slots[at(body)].lanes;
          if (group.body[l] >= 0 || along_trunk) parents.given |= 1U << l;
        }
        group.gives_all = group.gives_all && group.same_lanes && parents.given == parents.lanes;
        bool& leaf = plan_.lane_groups[at(parents.group)].leaf;
        parents.first = leaf;
        leaf = false;
      }
      // Measured: selecting between two parents is faster than gathering four.
      group.apart = group.parents_count > 2;
      for (int l = 0; l < group_lanes; ++l)
        for (int p = group.parents_count; p-- > 0;) {
          const LaneGroupParents& parents = group.parents[p];
          // Lanes without a body take some other lane's parent.
          if (p == 0 || (parents.lanes >> l & 1) != 0) {
            group.lane_parents[l] = {parents.group, parents.lane < 0 ? l : parents.lane, (parents.given >> l & 1) != 0};
            break;
          }
        }
    }
  }
  void findRootPaths() {
    // By lane group and lane: the first of the lanes that share the root path.
    std::vector<std::array<int, group_lanes>> first(plan_.lane_groups.size());
    for (std::size_t s = 1; s < plan_.lane_groups.size(); ++s) {
      LaneGroup& group = plan_.lane_groups[s];
      group.bodies = lanesOf(group.body, [](int body) { return body >= 0; });
      const auto together = [&](int l, int other) {
        for (int p = 0; p < group.parents_count; ++p) {
          const LaneGroupParents& parents = group.parents[p];
          if ((parents.lanes >> l & 1) == 0 || (parents.lanes >> other & 1) == 0) continue;
          const auto& above = first[at(parents.group)];
          return parents.group == 0 || parents.lane >= 0 || above[at(l)] == above[at(other)];
        }
        return false;
      };
      int count = 0;
      for (int l = 0; l < group_lanes; ++l) {
        first[s][at(l)] = l;
        for (int other = l; other-- > 0;)
          if (together(l, other)) first[s][at(l)] = other;
      }
      for (int l = 0; l < group_lanes; ++l)
        if (const unsigned lanes = group.bodies & lanesOf(first[s], [&](int other) { return other == l; })) group.root_paths[count++] = lanes;
    }
  }
  /// Chooses the algorithms that use lane groups. The factors are the cost of a lane group and, for inverse dynamics, of entering and leaving the
  /// lanes, in the time of one body. They were measured with and without lane groups (CompileOptions::lane_groups) on the legged and two-armed robots
  /// of ../shared/models, on a Zen 5. AVX2 has 16 registers, so the numbers of a lane group's four bodies are spilled to memory there, which slows
  /// down algorithms with many numbers per body.
  void judge(const std::string& instruction_set) {
    const double joints = m_.bodies() - 1;
    LaneGroupUses& uses = plan_.uses;
    uses.rnea = 1.3 * plan_.count + 2 < joints;
    if (!uses.rnea) return;
    const bool many_numbers = (instruction_set == "avx512" ? 2.8 : 3.24) * plan_.count < joints;
    const auto varies = [](const TypeBatch& batch) { return batch.shape == Shape::dense; };
    uses.aba = uses.centroidal_map = many_numbers;
    uses.derivatives = many_numbers && std::none_of(m_.batches.begin(), m_.batches.end(), varies);
    // The mass matrix has one entry for each step of each joint's root path. Where limbs branch, as in hands, few lanes take a step together.
    uses.mass_matrix = lanesOnRootPaths() > 3;
  }
  /// How many joints take a step towards the root together, on average.
  double lanesOnRootPaths() const {
    std::int64_t alone = 0, together = 0;
    for (int i = 1; i < m_.bodies(); ++i) alone += index(i).depth;
    // Each step takes every lane of a root path one body up, so all of these lanes have the same number of steps.
    for (int s = 1; s <= plan_.count; ++s)
      for (const unsigned lanes : plan_.lane_groups[at(s)].root_paths)
        if (lanes != 0) together += index(plan_.lane_groups[at(s)].body[std::countr_zero(lanes)]).depth;
    return static_cast<double>(alone) / static_cast<double>(together);
  }
  void runs() {
    for (int s = 1; s <= plan_.count; ++s) {
      const LaneGroup& group = plan_.lane_groups[at(s)];
      const bool goes_on = !plan_.runs.empty() && plan_.runs.back().shape == group.shape && plan_.runs.back().nv == group.nv;
      if (!goes_on) plan_.runs.push_back({s, s, group.shape, group.nv});
      plan_.runs.back().end = s + 1;
    }
  }

  void batches() {
    plan_.batches.resize(m_.batches.size());
    for (std::size_t s = 1; s < plan_.lane_groups.size(); ++s) {
      LaneGroup& group = plan_.lane_groups[s];
      LaneGroupBatch& batch = plan_.batches[at(group.batch)];
      group.slot = batch.slots++;
      const int someone = *std::find_if(group.body, group.body + group_lanes, [](int b) { return b >= 0; });
      for (const int body : group.shows) batch.bodies.push_back(body >= 0 ? body : someone);
    }
    for (std::size_t b = 0; b < m_.batches.size(); ++b) {
      const TypeBatch& from = m_.batches[b];
      LaneGroupBatch& to = plan_.batches[b];
      for (const int body : to.bodies) {
        to.q_index.push_back(m_.index[at(body)].idx_q);
        to.v_index.push_back(m_.index[at(body)].idx_v);
        to.pose_index.push_back(m_.index[at(body)].slot);
      }
      for (int c = 0; c < std::max(from.constant_count, 1); ++c)
        for (const int body : to.bodies) to.constants.push_back(from.constants[at(c * from.count + m_.index[at(body)].slot)]);
    }
  }

  /// Lists where the lanes' degrees of freedom are.
  void dofs() {
    for (int i = 1; i < m_.bodies(); ++i)
      for (int k = 0; k < index(i).nv; ++k)
        plan_.dof_place.push_back((plan_.lane_slots[at(i)].group_dof + k) * group_lanes + plan_.lane_slots[at(i)].lane);
    for (std::size_t s = 1; s < plan_.lane_groups.size(); ++s) {
      const LaneGroup& group = plan_.lane_groups[s];
      for (int k = 0; k < group.nv; ++k)
        for (int l = 0; l < group_lanes; ++l) {
          const int v = index(plan_.batches[at(group.batch)].bodies[at(group.slot * group_lanes + l)]).idx_v + k;
          plan_.dof_index.push_back(v);
          plan_.dof_row.push_back(static_cast<std::int64_t>(v) * m_.nvx);
        }
    }
    const auto isShared = [&](int dof) {
      const auto first = plan_.dof_index.begin() + group_lanes * dof;
      return std::all_of(first, first + group_lanes, [&](std::int64_t v) { return v == *first; });
    };
    while (plan_.shared_dofs < plan_.dofs && isShared(plan_.shared_dofs)) ++plan_.shared_dofs;
  }

  const CompactImpl& m_;
  LaneGroupPlan plan_;
  std::map<std::array<int, 3>, std::set<Rank>> children_;  ///< bodies that have no lane slot yet and whose parent has one
  std::map<Kind, std::set<Rank>> waiting_;                 ///< the same bodies
  std::vector<int> height_;                                ///< number of bodies from this one down to its farthest leaf
  std::vector<int> leaves_;                                ///< number of leaves below this one, or 1 at a leaf
};

}  // namespace

void writeLaneNumbers(LaneGroupPlan& out, const CompactImpl& m) {
  const LaneGroupPlan& plan = out;
  constexpr int size = sizeof(BodyConstants<double>) / sizeof(double);
  const std::size_t bytes = plan.lane_groups.size() * sizeof(BodyConstants<double>) * group_lanes;
  if (out.constants.bytes() < bytes) out.constants = PackMemory(bytes);
  out.armature.clear();
  auto* numbers = reinterpret_cast<double*>(out.constants.data());
  for (std::size_t s = 1; s < plan.lane_groups.size(); ++s) {
    const LaneGroup& group = plan.lane_groups[s];
    const int* bodies = plan.batches[at(group.batch)].bodies.data() + group.slot * group_lanes;
    for (int l = 0; l < group_lanes; ++l) {
      BodyConstants<double> c = m.constants[at(bodies[l])];
      if (group.shows[l] < 0 || (group.body[l] < 0 && parts(plan, m, bodies[l]))) c = {c.placement, 0, {}, {}, {}, {}};
      const auto* from = reinterpret_cast<const double*>(&c);
      for (int k = 0; k < size; ++k) numbers[(s * size + at(k)) * group_lanes + at(l)] = from[k];
    }
    for (int k = 0; k < group.nv; ++k)
      for (int l = 0; l < group_lanes; ++l)
        out.armature.push_back(group.shows[l] < 0 ? 1.0 : (m.armature.empty() ? 0.0 : m.armature[at(m.index[at(bodies[l])].idx_v + k)]));
  }
}

LaneGroupPlan assignLanes(const CompactImpl& m) { return Planner(m).assigned(); }

LaneGroupPlan planLaneGroups(const CompactImpl& m, const std::string& instruction_set) {
  const auto known = {"scalar", "baseline", "sse2", "avx2", "avx512"};
  if (std::find(known.begin(), known.end(), instruction_set) == known.end())
    throw Error(ErrorCode::argument,
                "compile: instruction_set '" + instruction_set + "' is not known; it is one of scalar, sse2 (baseline), avx2, avx512, or empty");
  const bool packs = instruction_set == "avx2" || instruction_set == "avx512";
  if (!packs || !m.couplings.empty() || m.bodies() < 2) return {};
  for (const TypeBatch& batch : m.batches)
    if (batch.shape == Shape::dense_constant) return {};
  return Planner(m).run(instruction_set);
}

}  // namespace dyn
