// SPDX-License-Identifier: BSD-2-Clause
// Visits the bodies in traced numbers. Bodies that share a lane group are visited as runs of the same code (GraphBuilder::packable).
#pragma once

#include "kernels/derivative/recursion.hpp"

#include <dyn/codegen/graph.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace dyn {

static_assert(most_packable == group_lanes);

/// Limbs says which bodies and degrees of freedom are packable: those that share a lane group, or none.
class Limbs {
 public:
  Limbs(const CompactImpl& m, bool packable);

  const CompactImpl& m;
  const bool packable;
  GraphBuilder* builder = nullptr;
  bool columns_by_neighbours = false;  ///< columns of matrices are packed with their neighbours, else by lane groups
  bool has_columns = false;            ///< whether columns of matrices were visited
  LaneGroupPlan plan;
  std::vector<Run> runs;          ///< by body: a run of this body alone
  std::vector<char> gives_first;  ///< by body: whether backward() visits it first among its parent's children
  /// By lane group and constant: whether the constant is 0, is 1, is -1, is negative or is positive in all bodies of the group alike. Then operations
  /// are simplified for all of them or for none.
  std::vector<std::vector<char>> uniform;

  bool several(int group) const {
    const int* body = plan.lane_groups[static_cast<std::size_t>(group)].body;
    return std::count_if(body, body + group_lanes, [](int b) { return b >= 0; }) > 1;
  }
  const LaneSlot& laneSlot(int body) const { return plan.lane_slots[static_cast<std::size_t>(body)]; }
};

/// The workspace of traced numbers, through which OrderOf<Traced> finds the limbs.
struct TracedWorkspace : Workspace<Traced> {
  Limbs* limbs = nullptr;
};

namespace kernels {

struct TracedBodies;

/// Notes the numbers that a body adds to those of its children.
template <class T>
struct NotedFromChildren : FromChildren<TracedBodies, T> {
  std::vector<Traced>& noted;

  T with(const T& own) const {
    note(own);
    return FromChildren<TracedBodies, T>::with(own);
  }
  const T& gather(const T& own) const {
    note(own);
    return FromChildren<TracedBodies, T>::gather(own);
  }

 private:
  void note(const T& own) const {
    const auto* numbers = reinterpret_cast<const Traced*>(&own);
    noted.insert(noted.end(), numbers, numbers + sizeof(T) / sizeof(Traced));
  }
};

struct TracedBodies : Bodies<Traced> {
  TracedBodies(const CompactImpl& model, Workspace<Traced>& workspace, Limbs& found) : Bodies{model, workspace}, limbs(found) {}
  Limbs& limbs;

  BodyConstants<Traced> constants(int i) const;
  void handOver(auto* array, int i, const auto& value) const {
    nextStep(false);
    auto& sum = array[parentOf(i)];
    if (limbs.gives_first[static_cast<std::size_t>(i)]) {
      sum = value;
    } else {
      sum += value;
    }
    nextStep();
  }
  // Not all lanes have children, so the operations from here to unite() form a step of their own.
  bool isLeaf(int i) const {
    nextStep();
    return Bodies::isLeaf(i);
  }
  template <class T>
  void unite(int, T&) const {
    nextStep();
  }

  BodyEntry<TracedBodies, Traced> entry(Traced* M, int i, int iv) const { return {*this, M, i, iv}; }
  void reaches(int i) const { limbs.builder->step(reached + limbs.laneSlot(i).group); }
  void goesUp(int dof) const { limbs.builder->step(reached + placeOf(dof)); }
  void goesDown(int dof) const { limbs.builder->step(down + dof); }

  /// Marks neighbouring degrees of freedom as packable, since the same code computes their numbers in the array.
  template <class Value>
  void neighboursPackable(const Value* array) const {
    neighboursPackable(m.nvx, sizeof(Value) / sizeof(Traced),
                       [&](int dof, std::size_t k) { return reinterpret_cast<const Traced*>(array + dof)[k]; });
  }

  /// Calls use(dof) for the degrees of freedom from `first` to `end`. Those of one lane group are packed, else neighbours; for columns of matrices
  /// Limbs::columns_by_neighbours decides.
  template <class Use>
  void eachDof(int first, int end, Use&& use) const {
    const bool columns = !visiting_;
    limbs.has_columns = limbs.has_columns || columns;
    eachTogether(first, end, use, [&](int dof, auto&& isOpen) {
      if (columns && limbs.columns_by_neighbours) return neighboursOf(dof, isOpen);
      std::array<int, group_lanes> dofs = nobody;
      const int body = m.dof_body[static_cast<std::size_t>(dof)], k = dof - index(body).idx_v;
      int count = 0;
      for (std::size_t l = 0; l < dofs.size(); ++l) {
        const int other = limbs.plan.lane_groups[static_cast<std::size_t>(limbs.laneSlot(body).group)].body[l];
        if (other < 0 || !isOpen(index(other).idx_v + k)) continue;
        dofs[l] = index(other).idx_v + k;
        ++count;
      }
      return count > 1 ? dofs : neighboursOf(dof, [&](int other) { return isOpen(other) && alone(other, first, end); });
    });
  }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (std::size_t s = 1; s < limbs.plan.lane_groups.size(); ++s)
      overLaneGroup(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply([&](T*... x) { body(joint, i, index(i).idx_v, FromParent<TracedBodies, T>(*this, x, i)...); }, arrays);
      });
  }
  /// Also marks neighbouring bodies as packable, since the same code computes what they add themselves.
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    std::vector<std::vector<Traced>> own(static_cast<std::size_t>(m.bodies()));
    for (std::size_t s = limbs.plan.lane_groups.size(); s-- > 1;)
      overLaneGroup(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply(
            [&](T*... x) {
              body(joint, i, index(i).idx_v, NotedFromChildren<T>{{*this, x, i}, own[static_cast<std::size_t>(i)]}...);
            },
            arrays);
      });
    std::size_t most = 0;
    for (const std::vector<Traced>& numbers : own) most = std::max(most, numbers.size());
    neighboursPackable(m.bodies(), most, [&](int i, std::size_t k) {
      const std::vector<Traced>& numbers = own[static_cast<std::size_t>(i)];
      return k < numbers.size() ? numbers[k] : Traced();
    });
  }

 private:
  static constexpr int reached = 1 << 24, down = 2 << 24, along = 3 << 24;

  static constexpr std::array<int, group_lanes> nobody{-1, -1, -1, -1};

  /// Marks neighbours among `count` items as packable, number by number; each item has up to `numbers` of them.
  template <class NumberOf>
  void neighboursPackable(int count, std::size_t numbers, NumberOf&& numberOf) const {
    if (!limbs.packable) return;
    for (int first = count % most_packable - most_packable; first < count; first += most_packable)
      for (std::size_t k = 0; k < numbers; ++k) {
        std::array<Traced, most_packable> neighbours;
        for (int l = std::max(-first, 0); l < most_packable; ++l) neighbours[static_cast<std::size_t>(l)] = numberOf(first + l, k);
        limbs.builder->markPackable(neighbours);
      }
  }
  /// choose(dof, isOpen) returns by lane those degrees of freedom, out of the open ones, that are packed with dof.
  template <class Use, class Choose>
  void eachTogether(int first, int end, Use&& use, Choose&& choose) const {
    GraphBuilder& builder = *limbs.builder;
    if (builder.inRun() || !limbs.packable) {
      for (int dof = first; dof < end; ++dof) {
        builder.step(along + dof - first);
        use(dof);
      }
      return;
    }
    std::vector<char> done(static_cast<std::size_t>(end), 0);
    for (int dof = first; dof < end; ++dof) {
      if (done[static_cast<std::size_t>(dof)]) continue;
      const std::array<int, group_lanes> dofs =
          choose(dof, [&](int other) { return other >= first && other < end && !done[static_cast<std::size_t>(other)]; });
      builder.packable([&] {
        for (int l = 0; l < group_lanes; ++l) {
          const int next = dofs[static_cast<std::size_t>(l)];
          if (next < 0) continue;
          builder.run(l);
          builder.step(along);
          use(next);
          done[static_cast<std::size_t>(next)] = 1;
        }
      });
    }
  }
  /// Returns dof and the degrees of freedom after it up to the end of their pack. The last pack ends with the last degree of freedom, so packs far
  /// from the root are full.
  template <class May>
  std::array<int, group_lanes> neighboursOf(int dof, May&& may) const {
    std::array<int, group_lanes> dofs = nobody;
    const int lane = (dof + group_lanes - m.nvx % group_lanes) % group_lanes;
    for (int l = lane; l < group_lanes; ++l)
      if (const int other = dof - lane + l; may(other)) dofs[static_cast<std::size_t>(l)] = other;
    return dofs;
  }
  int placeOf(int dof) const {
    const int body = m.dof_body[static_cast<std::size_t>(dof)];
    return limbs.laneSlot(body).group_dof + dof - index(body).idx_v;
  }
  /// Whether no other body of dof's lane group has degrees of freedom between `first` and `end`.
  bool alone(int dof, int first, int end) const {
    const int body = m.dof_body[static_cast<std::size_t>(dof)];
    const LaneGroup& group = limbs.plan.lane_groups[static_cast<std::size_t>(limbs.laneSlot(body).group)];
    return std::none_of(group.body, group.body + group_lanes,
                        [&](int other) { return other >= 0 && other != body && index(other).idx_v >= first && index(other).idx_v < end; });
  }
  void nextStep(bool compared = true) const {
    ++step_;
    limbs.builder->step(compared ? step_ : -1);
  }
  template <class Visit>
  void overLaneGroup(int s, Visit&& visit) const {
    GraphBuilder& builder = *limbs.builder;
    const LaneGroup& group = limbs.plan.lane_groups[static_cast<std::size_t>(s)];
    const auto visitBody = [&](int i) {
      const Run& run = limbs.runs[static_cast<std::size_t>(i)];
      withShape<Traced>(run.shape, run.nv, [&]<class Joint>() {
        const Slot<Traced> slot = slotOf(run, 0);
        visiting_ = true;
        visit(Joint(slot), i);
        visiting_ = false;
      });
    };
    if (!limbs.several(s)) {
      for (const int i : group.body)
        if (i >= 0) visitBody(i);
      return;
    }
    builder.packable([&] {
      for (int l = 0; l < group_lanes; ++l) {
        if (group.body[l] < 0) continue;
        builder.run(l);
        step_ = 0;
        nextStep();
        visitBody(group.body[l]);
      }
    });
  }

  mutable int step_ = 0;
  mutable bool visiting_ = false;
};

template <>
struct OrderOf<Traced> {
  using type = TracedBodies;
  static type over(const CompactImpl& m, Workspace<Traced>& w) { return {m, w, *static_cast<TracedWorkspace&>(w).limbs}; }
};

}  // namespace kernels
}  // namespace dyn
