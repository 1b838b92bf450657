// Walking the bodies in traced numbers: those of limbs that are alike one after the other, as runs of the same code (GraphBuilder::abreast).
#pragma once

#include "kernels/recursion.hpp"

#include <dyn/codegen/graph.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace dyn {

static_assert(most_abreast == strip_lanes);

/// Which bodies, and degrees of freedom, are walked abreast: as the plan of strips seats them, or each for itself.
class Limbs {
 public:
  Limbs(const CompactImpl& m, bool abreast);

  const CompactImpl& m;
  const bool abreast;
  GraphBuilder* builder = nullptr;
  StripPlan plan;
  std::vector<Run> runs;                   ///< by body: itself
  std::vector<char> gives_first;           ///< by body: of its parent's children the one that is met first on the way inward
  std::vector<std::vector<char>> uniform;  ///< by strip: which of the bodies' constants are such that nothing may be simplified for one of them alone

  bool several(int strip) const { return bodiesIn(strip) > 1; }
  int bodiesIn(int strip) const {
    const int* body = plan.strips[static_cast<std::size_t>(strip)].body;
    return static_cast<int>(std::count_if(body, body + strip_lanes, [](int b) { return b >= 0; }));
  }
  const Seat& seat(int body) const { return plan.seats[static_cast<std::size_t>(body)]; }
};

/// Workspaces of traced numbers are these.
struct TracedWorkspace : Workspace<Traced> {
  Limbs* limbs = nullptr;
};

namespace kernels {

struct TracedBodies : Bodies<Traced> {
  TracedBodies(const CompactImpl& model, Workspace<Traced>& workspace, Limbs& alike) : Bodies{model, workspace}, limbs(alike) {}
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
  // What lanes do in between is compared for itself: not all of them have children.
  bool isLeaf(int i) const {
    nextStep();
    return Bodies::isLeaf(i);
  }
  template <class T>
  void unite(int, T&) const {
    nextStep();
  }

  BodyEntry<TracedBodies, Traced> entry(Traced* M, int i, int iv) const { return {*this, M, i, iv}; }
  void reaches(int i) const { limbs.builder->step(reached + limbs.seat(i).strip); }
  void goesUp(int dof) const { limbs.builder->step(reached + placeOf(dof)); }
  void goesDown(int dof) const { limbs.builder->step(down + dof); }

  template <class Use>
  void eachDof(int first, int end, Use&& use) const {
    GraphBuilder& builder = *limbs.builder;
    if (builder.inRun() || !limbs.abreast) {
      for (int dof = first; dof < end; ++dof) {
        builder.step(along + dof - first);
        use(dof);
      }
      return;
    }
    std::vector<char> done(static_cast<std::size_t>(end), 0);
    const auto together = [&](const std::array<int, strip_lanes>& dofs) {
      builder.abreast([&] {
        for (int l = 0; l < strip_lanes; ++l) {
          const int dof = dofs[static_cast<std::size_t>(l)];
          if (dof < 0) continue;
          builder.run(l);
          builder.step(along);
          use(dof);
          done[static_cast<std::size_t>(dof)] = 1;
        }
      });
    };
    for (int dof = first; dof < end; ++dof) {
      if (done[static_cast<std::size_t>(dof)]) continue;
      const int body = m.dof_body[static_cast<std::size_t>(dof)], k = dof - index(body).idx_v;
      std::array<int, strip_lanes> dofs;
      int count = 0;
      for (int l = 0; l < strip_lanes; ++l) {
        const int other = limbs.plan.strips[static_cast<std::size_t>(limbs.seat(body).strip)].body[l];
        int& of_lane = dofs[static_cast<std::size_t>(l)] = other < 0 ? -1 : index(other).idx_v + k;
        if (of_lane < first || of_lane >= end) of_lane = -1;
        count += of_lane >= 0 ? 1 : 0;
      }
      if (count < 2) {
        // Neighbours, then.
        dofs = {-1, -1, -1, -1};
        const int begin = dof / strip_lanes * strip_lanes;
        for (int l = 0; l < strip_lanes; ++l) {
          const int other = begin + l;
          if (other >= dof && other < end && !done[static_cast<std::size_t>(other)] && alone(other, first, end))
            dofs[static_cast<std::size_t>(l)] = other;
        }
      }
      together(dofs);
    }
  }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (std::size_t s = 1; s < limbs.plan.strips.size(); ++s)
      overStrip(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply([&](T*... x) { body(joint, i, index(i).idx_v, FromParent<TracedBodies, T>(*this, x, i)...); }, arrays);
      });
  }
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    for (std::size_t s = limbs.plan.strips.size(); s-- > 1;)
      overStrip(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply([&](T*... x) { body(joint, i, index(i).idx_v, FromChildren<TracedBodies, T>(*this, x, i)...); }, arrays);
      });
  }

 private:
  static constexpr int reached = 1 << 24, down = 2 << 24, along = 3 << 24;

  int placeOf(int dof) const {
    const int body = m.dof_body[static_cast<std::size_t>(dof)];
    return limbs.seat(body).strip_dof + dof - index(body).idx_v;
  }
  /// Of the degrees of freedom of a range no other is in its strip.
  bool alone(int dof, int first, int end) const {
    const int body = m.dof_body[static_cast<std::size_t>(dof)];
    const Strip& strip = limbs.plan.strips[static_cast<std::size_t>(limbs.seat(body).strip)];
    return std::none_of(strip.body, strip.body + strip_lanes,
                        [&](int other) { return other >= 0 && other != body && index(other).idx_v >= first && index(other).idx_v < end; });
  }
  void nextStep(bool compared = true) const {
    ++step_;
    limbs.builder->step(compared ? step_ : -1);
  }
  template <class Visit>
  void overStrip(int s, Visit&& visit) const {
    GraphBuilder& builder = *limbs.builder;
    const Strip& strip = limbs.plan.strips[static_cast<std::size_t>(s)];
    const auto visitBody = [&](int i) {
      const Run& run = limbs.runs[static_cast<std::size_t>(i)];
      withShape<Traced>(run.shape, run.nv, [&]<class Joint>() {
        const Slot<Traced> slot = slotOf(run, 0);
        visit(Joint(slot), i);
      });
    };
    if (!limbs.several(s)) {
      for (const int i : strip.body)
        if (i >= 0) visitBody(i);
      return;
    }
    builder.abreast([&] {
      for (int l = 0; l < strip_lanes; ++l) {
        if (strip.body[l] < 0) continue;
        builder.run(l);
        step_ = 0;
        nextStep();
        visitBody(strip.body[l]);
      }
    });
  }

  mutable int step_ = 0;
};

template <>
struct OrderOf<Traced> {
  using type = TracedBodies;
  static type over(const CompactImpl& m, Workspace<Traced>& w) { return {m, w, *static_cast<TracedWorkspace&>(w).limbs}; }
};

}  // namespace kernels
}  // namespace dyn
