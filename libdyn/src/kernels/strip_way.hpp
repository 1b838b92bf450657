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
  StripWay(const CompactImpl& m, int i) : plan_(m.strips), strip_(&plan_.strips[at(i)]) {}

  /// Calls along(climb) for each way that lanes with a body go together, and climb(use) calls use(step) for each step of it, strip by strip.
  template <class Along>
  void each(Along&& along) const {
    for (const unsigned lanes : strip_->ways) {
      if (lanes == 0) return;
      along([&](auto&& use) { climb(lanes, use); });
    }
  }
  /// Where all are.
  auto here() const { return Abreast{plan_, strip_, strip_, strip_->bodies}; }

 private:
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  /// In lanes of their own as long as they go on as they are; from where they meet, or change the lane, all are where one is.
  template <class Use>
  void climb(unsigned lanes, Use&& use) const {
    const Strip* from = strip_;
    const StripParents* parents = parentsOf(from, lanes);
    while (from->depth > 1 && parents->lane < 0) {
      const Strip* to = &plan_.strips[at(parents->strip)];
      use(Abreast{plan_, from, to, lanes});
      from = to;
      parents = parentsOf(from, lanes);
    }
    for (int lane = -1; from->depth > 1;) {
      const Strip* to = &plan_.strips[at(parents->strip)];
      const int next = parents->lane < 0 ? lane : parents->lane;
      use(InOne{plan_, from, lane, to, next, lanes});
      lane = next;
      from = to;
      parents = parentsOf(from, 1U << lane);
    }
  }
  static const StripParents* parentsOf(const Strip* strip, unsigned lanes) {
    const StripParents* parents = strip->parents;
    while ((parents->lanes & lanes) == 0) ++parents;
    return parents;
  }

  class Step {
   public:
    Step(const StripPlan& plan, const Strip* from, const Strip* to, unsigned lanes)
        : plan_(plan), from_(from), to_(to), lanes_(lanes), dofs_(plan.dof_index.data() + strip_lanes * to->dof) {}
    int nv() const { return to_->nv; }
    bool flyingRoot() const { return to_->shape == Shape::free && to_->depth == 1; }
    bool turnsOnly() const { return dyn::turnsOnly(to_->shape); }
    /// Whether this lane has something to enter.
    bool enters(int lane) const { return (lanes_ >> lane & 1) != 0; }

   protected:
    std::ptrdiff_t from() const { return from_ - plan_.strips.data(); }
    const StripPlan& plan_;
    const Strip *from_, *to_;
    unsigned lanes_;
    const std::int64_t* dofs_;
  };
  struct Abreast : Step {
    using Step::Step;
    /// What an array by strip has of the bodies that lanes came from.
    template <class T>
    const T& left(const T* array) const {
      return array[this->from()];
    }
    /// The part that `of` names of what an array has of the l-th degrees of freedom of those that they came to.
    template <class T, class Of>
    const auto& reached(const T* array, int l, Of&& of) const {
      return of(array[this->to_->dof + l]);
    }
    /// The model's number of a lane's l-th.
    std::ptrdiff_t dof(int lane, int l) const { return this->dofs_[strip_lanes * l + lane]; }
  };
  class InOne : public Step {
   public:
    InOne(const StripPlan& plan, const Strip* from, int from_lane, const Strip* to, int to_lane, unsigned lanes)
        : Step(plan, from, to, lanes), from_lane_(from_lane), to_lane_(to_lane) {}
    template <class T>
    T left(const T* array) const {
      const T& x = array[this->from()];
      return from_lane_ < 0 ? x : inAllLanes<S>(x, from_lane_);
    }
    template <class T, class Of>
    auto reached(const T* array, int l, Of&& of) const {
      return inAllLanes<S>(of(array[this->to_->dof + l]), to_lane_);
    }
    std::ptrdiff_t dof(int, int l) const { return this->dofs_[strip_lanes * l + to_lane_]; }

   private:
    int from_lane_, to_lane_;  ///< the former: -1 for lanes of their own
  };

  const StripPlan& plan_;
  const Strip* strip_;
};

/// Calls write(lane) for the lanes that have something to enter at a step, lane a constant.
template <class Step, class Write>
void inEnteringLanes(const Step& step, Write&& write) {
  [&]<int... lane>(std::integer_sequence<int, lane...>) {
    ((step.enters(lane) ? write(std::integral_constant<int, lane>()) : void()), ...);
  }(std::make_integer_sequence<int, strip_lanes>());
}
/// Taken from a register.
template <int lane, class S>
double laneOf(const S& x) {
  return static_cast<Four>(x.x)[lane];
}

/// Of a flying root's six numbers, four lanes' packs each: lane by lane to six that follow one another. Four and two: nothing is written twice,
/// so that who reads as much at once need not wait.
template <class S, class To>
void putSixes(const Force<S>& f, To&& to) {
  const auto pack = [&](int c) { return static_cast<Four>(packsOf<S>(f)[c].x); };
  Square<double, 4> fours;
  for (int c = 0; c < 4; ++c) fours.rows[c] = pack(c);
  fours.transpose();
  const Four even = __builtin_shufflevector(pack(4), pack(5), 0, 4, 2, 6), odd = __builtin_shufflevector(pack(4), pack(5), 1, 5, 3, 7);
  const auto put = [&]<int lane>(std::integral_constant<int, lane>) {
    double* const six = to(lane);
    if (six == nullptr) return;
    constexpr int half = lane / 2 * 2;
    const Four& twos = lane % 2 == 0 ? even : odd;
    fours.write(lane, six);
    *reinterpret_cast<Square<double, 2>::Unaligned*>(six + 4) = __builtin_shufflevector(twos, twos, half, half + 1);
  };
  [&]<int... lane>(std::integer_sequence<int, lane...>) { (put(std::integral_constant<int, lane>()), ...); }(std::make_integer_sequence<int, 4>());
}

}  // namespace dyn::kernels
