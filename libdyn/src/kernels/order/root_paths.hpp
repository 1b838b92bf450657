// SPDX-License-Identifier: BSD-2-Clause
// The root paths of a lane group's four joints.
#pragma once

#include "kernels/body/workspace.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/pack/lanes.hpp"

#include <algorithm>
#include <utility>

namespace dyn::kernels {

/// The root paths of the joints of one lane group. A step describes the bodies that the lanes have reached. Matrix entries are written for the
/// degrees of freedom of their joints, paired with those of the lane group's own joints.
template <class S>
class RootPaths {
 public:
  RootPaths(const CompactImpl& m, int i) : plan_(m.lane_groups), i_(i) {}

  /// Calls along(climb) for each root path that lanes with a body share. climb(use) calls use(step) for each step of the path, lane group by lane
  /// group.
  template <class Along>
  void each(Along&& along) const {
    for (const unsigned lanes : group(i_).root_paths) {
      if (lanes == 0) return;
      along([&](auto&& use) { climb(lanes, use); });
    }
  }
  /// The step that stands at the lane group itself, with all its lanes.
  auto here() const { return InOwnLanes{plan_, i_, i_, group(i_).bodies}; }

 private:
  const LaneGroup& group(int i) const { return plan_.lane_groups[static_cast<std::size_t>(i)]; }

  /// Each lane stays in its own lane as long as its parents do. From where lanes meet or change, all of them are in one lane.
  template <class Use>
  void climb(unsigned lanes, Use&& use) const {
    int from = i_;
    LaneGroupParents parents = parentsOf(from, lanes);
    while (parents.group > 0 && parents.lane < 0) {
      use(InOwnLanes{plan_, from, parents.group, lanes});
      from = parents.group;
      parents = parentsOf(from, lanes);
    }
    for (int lane = -1; parents.group > 0;) {
      const int next = parents.lane < 0 ? lane : parents.lane;
      use(ByOneLane{plan_, from, lane, parents.group, next, lanes});
      lane = next;
      from = parents.group;
      parents = parentsOf(from, 1U << lane);
    }
  }
  LaneGroupParents parentsOf(int i, unsigned lanes) const {
    const LaneGroupParents* parents = group(i).parents;
    while ((parents->lanes & lanes) == 0) ++parents;
    return *parents;
  }

  class Step {
   public:
    Step(const LaneGroupPlan& plan, int from, int to, unsigned lanes)
        : from_(from),
          to_(plan.lane_groups[static_cast<std::size_t>(to)]),
          lanes_(lanes),
          dofs_(plan.dof_index.data() + group_lanes * to_.dof),
          rows_(plan.dof_row.data() + group_lanes * to_.dof) {}
    int nv() const { return to_.nv; }
    bool floatingBase() const { return to_.shape == Shape::free && to_.depth == 1; }
    bool turnsOnly() const { return dyn::turnsOnly(to_.shape); }
    /// The lanes that have entries to write, one bit each.
    unsigned entering() const { return lanes_; }

   protected:
    int from_;
    const LaneGroup& to_;
    unsigned lanes_;
    const std::int64_t *dofs_, *rows_;
  };
  struct InOwnLanes : Step {
    using Step::Step;
    /// The entries, in an array by lane group, of the bodies that the lanes came from.
    template <class T>
    const T& left(const T* array) const {
      return array[this->from_];
    }
    /// The part that `of` selects of the entries, in an array by degree of freedom, for the l-th ones of the bodies that the lanes reached.
    template <class T, class Of>
    const auto& reached(const T* array, int l, Of&& of) const {
      return of(array[this->to_.dof + l]);
    }
    /// The model's number of a lane's l-th degree of freedom, and where its row or column of nvx numbers begins in a matrix.
    std::ptrdiff_t dof(int lane, int l) const { return this->dofs_[group_lanes * l + lane]; }
    std::ptrdiff_t row(int lane, int l) const { return this->rows_[group_lanes * l + lane]; }
  };
  class ByOneLane : public Step {
   public:
    ByOneLane(const LaneGroupPlan& plan, int from, int from_lane, int to, int to_lane, unsigned lanes)
        : Step(plan, from, to, lanes), from_lane_(from_lane), to_lane_(to_lane) {}
    template <class T>
    T left(const T* array) const {
      const T& x = array[this->from_];
      return from_lane_ < 0 ? x : inAllLanes<S>(x, from_lane_);
    }
    template <class T, class Of>
    auto reached(const T* array, int l, Of&& of) const {
      return inAllLanes<S>(of(array[this->to_.dof + l]), to_lane_);
    }
    std::ptrdiff_t dof(int, int l) const { return this->dofs_[group_lanes * l + to_lane_]; }
    std::ptrdiff_t row(int, int l) const { return this->rows_[group_lanes * l + to_lane_]; }

   private:
    int from_lane_, to_lane_;  ///< from_lane_ is -1 where each lane came from its own lane
  };

  const LaneGroupPlan& plan_;
  int i_;
};

/// Calls write(lane), where lane is a constant, for the lanes that have entries to write at a step. Usually all lanes have some.
template <class Step, class Write>
void inEnteringLanes(const Step& step, Write&& write) {
  const unsigned entering = step.entering();
  [&]<int... lane>(std::integer_sequence<int, lane...>) {
    if (entering == (1U << group_lanes) - 1) {
      (write(std::integral_constant<int, lane>()), ...);
    } else {
      ((entering >> lane & 1 ? write(std::integral_constant<int, lane>()) : void()), ...);
    }
  }(std::make_integer_sequence<int, group_lanes>());
}
/// One lane of x, taken from a register.
template <int lane, class S>
double laneOf(const S& x) {
  return static_cast<Vec4d>(x.x)[lane];
}

/// Writes the six numbers of f, lane by lane, to six consecutive numbers from to(lane) on, for the lanes that a step enters. It writes four numbers
/// and then two. Nothing is written twice, so a reader of the same blocks need not wait.
template <class Step, class S, class To>
void putSixes(const Step& step, const Force<S>& f, To&& to) {
  const auto pack = [&](int c) { return static_cast<Vec4d>(packsOf<S>(f)[c].x); };
  Square<double, 4> fours;
  for (int c = 0; c < 4; ++c) fours.rows[c] = pack(c);
  fours.transpose();
  const Vec4d even = __builtin_shufflevector(pack(4), pack(5), 0, 4, 2, 6), odd = __builtin_shufflevector(pack(4), pack(5), 1, 5, 3, 7);
  inEnteringLanes(step, [&]<int lane>(std::integral_constant<int, lane>) {
    double* const six = to(lane);
    constexpr int half = lane / 2 * 2;
    const Vec4d& twos = lane % 2 == 0 ? even : odd;
    fours.write(lane, six);
    *reinterpret_cast<Square<double, 2>::Unaligned*>(six + 4) = __builtin_shufflevector(twos, twos, half, half + 1);
  });
}

}  // namespace dyn::kernels
