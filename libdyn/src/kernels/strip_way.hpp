// The way of a strip's four joints up to the root.
#pragma once

#include "kernels/columns.hpp"
#include "kernels/lanes.hpp"
#include "kernels/workspace.hpp"

#include <algorithm>
#include <utility>

namespace dyn::kernels {

/// Of the joints of one strip. Steps tell of the bodies that lanes have come to: their joints' degrees of freedom, of which numbers are entered with
/// those of the strip's own joints.
template <class S>
class StripWay {
 public:
  StripWay(const CompactImpl& m, int i) : plan_(m.strips), i_(i) {}

  /// Calls along(climb) for each way that lanes with a body go together, and climb(use) calls use(step) for each step of it, strip by strip.
  template <class Along>
  void each(Along&& along) const {
    for (const unsigned lanes : strip(i_).ways) {
      if (lanes == 0) return;
      along([&](auto&& use) { climb(lanes, use); });
    }
  }
  /// Where all are.
  auto here() const { return Abreast{plan_, i_, i_, strip(i_).bodies}; }

 private:
  const Strip& strip(int i) const { return plan_.strips[static_cast<std::size_t>(i)]; }

  /// In lanes of their own as long as they go on as they are; from where they meet, or change the lane, all are where one is.
  template <class Use>
  void climb(unsigned lanes, Use&& use) const {
    int from = i_;
    StripParents parents = parentsOf(from, lanes);
    while (parents.strip > 0 && parents.lane < 0) {
      use(Abreast{plan_, from, parents.strip, lanes});
      from = parents.strip;
      parents = parentsOf(from, lanes);
    }
    for (int lane = -1; parents.strip > 0;) {
      const int next = parents.lane < 0 ? lane : parents.lane;
      use(InOne{plan_, from, lane, parents.strip, next, lanes});
      lane = next;
      from = parents.strip;
      parents = parentsOf(from, 1U << lane);
    }
  }
  StripParents parentsOf(int i, unsigned lanes) const {
    const StripParents* parents = strip(i).parents;
    while ((parents->lanes & lanes) == 0) ++parents;
    return *parents;
  }

  class Step {
   public:
    Step(const StripPlan& plan, int from, int to, unsigned lanes)
        : from_(from),
          to_(plan.strips[static_cast<std::size_t>(to)]),
          lanes_(lanes),
          dofs_(plan.dof_index.data() + strip_lanes * to_.dof),
          rows_(plan.dof_row.data() + strip_lanes * to_.dof) {}
    int nv() const { return to_.nv; }
    bool flyingRoot() const { return to_.shape == Shape::free && to_.depth == 1; }
    bool turnsOnly() const { return dyn::turnsOnly(to_.shape); }
    /// The lanes that have something to enter, a bit each.
    unsigned entering() const { return lanes_; }

   protected:
    int from_;
    const Strip& to_;
    unsigned lanes_;
    const std::int64_t *dofs_, *rows_;
  };
  struct Abreast : Step {
    using Step::Step;
    /// What an array by strip has of the bodies that lanes came from.
    template <class T>
    const T& left(const T* array) const {
      return array[this->from_];
    }
    /// The part that `of` names of what an array has of the l-th degrees of freedom of those that they came to.
    template <class T, class Of>
    const auto& reached(const T* array, int l, Of&& of) const {
      return of(array[this->to_.dof + l]);
    }
    /// The model's number of a lane's l-th, and where its row or column of nvx numbers begins in a matrix.
    std::ptrdiff_t dof(int lane, int l) const { return this->dofs_[strip_lanes * l + lane]; }
    std::ptrdiff_t row(int lane, int l) const { return this->rows_[strip_lanes * l + lane]; }
  };
  class InOne : public Step {
   public:
    InOne(const StripPlan& plan, int from, int from_lane, int to, int to_lane, unsigned lanes)
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
    std::ptrdiff_t dof(int, int l) const { return this->dofs_[strip_lanes * l + to_lane_]; }
    std::ptrdiff_t row(int, int l) const { return this->rows_[strip_lanes * l + to_lane_]; }

   private:
    int from_lane_, to_lane_;  ///< the former: -1 for lanes of their own
  };

  const StripPlan& plan_;
  int i_;
};

/// Calls write(lane) for the lanes that have something to enter at a step, lane a constant. Most often all of them have.
template <class Step, class Write>
void inEnteringLanes(const Step& step, Write&& write) {
  const unsigned entering = step.entering();
  [&]<int... lane>(std::integer_sequence<int, lane...>) {
    if (entering == (1U << strip_lanes) - 1) {
      (write(std::integral_constant<int, lane>()), ...);
    } else {
      ((entering >> lane & 1 ? write(std::integral_constant<int, lane>()) : void()), ...);
    }
  }(std::make_integer_sequence<int, strip_lanes>());
}
/// Taken from a register.
template <int lane, class S>
double laneOf(const S& x) {
  return static_cast<Four>(x.x)[lane];
}

/// Of six numbers, four lanes' packs each: lane by lane to six that follow one another from to(lane) on, where a step enters something. Four and
/// two: nothing is written twice, so that who reads as much at once need not wait.
template <class Step, class S, class To>
void putSixes(const Step& step, const Force<S>& f, To&& to) {
  const auto pack = [&](int c) { return static_cast<Four>(packsOf<S>(f)[c].x); };
  Square<double, 4> fours;
  for (int c = 0; c < 4; ++c) fours.rows[c] = pack(c);
  fours.transpose();
  const Four even = __builtin_shufflevector(pack(4), pack(5), 0, 4, 2, 6), odd = __builtin_shufflevector(pack(4), pack(5), 1, 5, 3, 7);
  inEnteringLanes(step, [&]<int lane>(std::integral_constant<int, lane>) {
    double* const six = to(lane);
    constexpr int half = lane / 2 * 2;
    const Four& twos = lane % 2 == 0 ? even : odd;
    fours.write(lane, six);
    *reinterpret_cast<Square<double, 2>::Unaligned*>(six + 4) = __builtin_shufflevector(twos, twos, half, half + 1);
  });
}

}  // namespace dyn::kernels
