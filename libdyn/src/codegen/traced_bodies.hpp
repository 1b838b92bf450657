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
  bool columns_by_neighbours = false;  ///< which columns of matrices go abreast: those of limbs that are alike, or neighbours
  bool has_columns = false;            ///< whether there were some
  StripPlan plan;
  std::vector<Run> runs;                   ///< by body: itself
  std::vector<char> gives_first;           ///< by body: of its parent's children the one that is met first on the way inward
  std::vector<std::vector<char>> uniform;  ///< by strip: which of the bodies' constants are such that nothing may be simplified for one of them alone

  bool several(int strip) const {
    const int* body = plan.strips[static_cast<std::size_t>(strip)].body;
    return std::count_if(body, body + strip_lanes, [](int b) { return b >= 0; }) > 1;
  }
  const Seat& seat(int body) const { return plan.seats[static_cast<std::size_t>(body)]; }
};

/// Workspaces of traced numbers are these.
struct TracedWorkspace : Workspace<Traced> {
  Limbs* limbs = nullptr;
};

namespace kernels {

struct TracedBodies;

/// Notes what bodies have by themselves.
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

  /// Tells that all degrees of freedom's numbers in the array are found by the same code.
  template <class Value>
  void neighboursAlike(const Value* array) const {
    neighboursAlike(m.nvx, sizeof(Value) / sizeof(Traced), [&](int dof, std::size_t k) { return reinterpret_cast<const Traced*>(array + dof)[k]; });
  }

  /// In lanes those of limbs that are alike, else neighbours; columns of matrices as the limbs say.
  template <class Use>
  void eachDof(int first, int end, Use&& use) const {
    const bool columns = !visiting_;
    limbs.has_columns = limbs.has_columns || columns;
    eachTogether(first, end, use, [&](int dof, auto&& isOpen) {
      if (columns && limbs.columns_by_neighbours) return neighboursOf(dof, isOpen);
      std::array<int, strip_lanes> dofs = nobody;
      const int body = m.dof_body[static_cast<std::size_t>(dof)], k = dof - index(body).idx_v;
      int count = 0;
      for (std::size_t l = 0; l < dofs.size(); ++l) {
        const int other = limbs.plan.strips[static_cast<std::size_t>(limbs.seat(body).strip)].body[l];
        if (other < 0 || !isOpen(index(other).idx_v + k)) continue;
        dofs[l] = index(other).idx_v + k;
        ++count;
      }
      return count > 1 ? dofs : neighboursOf(dof, [&](int other) { return isOpen(other) && alone(other, first, end); });
    });
  }

  template <class Body, class... T>
  void forward(std::tuple<T*...> arrays, Body&& body) const {
    for (std::size_t s = 1; s < limbs.plan.strips.size(); ++s)
      overStrip(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply([&](T*... x) { body(joint, i, index(i).idx_v, FromParent<TracedBodies, T>(*this, x, i)...); }, arrays);
      });
  }
  /// What bodies have by themselves, neighbours have found by the same code.
  template <class Body, class... T>
  void backward(std::tuple<T*...> arrays, Body&& body) const {
    std::vector<std::vector<Traced>> own(static_cast<std::size_t>(m.bodies()));
    for (std::size_t s = limbs.plan.strips.size(); s-- > 1;)
      overStrip(static_cast<int>(s), [&]<class Joint>(const Joint& joint, int i) {
        std::apply(
            [&](T*... x) {
              body(joint, i, index(i).idx_v, NotedFromChildren<T>{{*this, x, i}, own[static_cast<std::size_t>(i)]}...);
            },
            arrays);
      });
    std::size_t most = 0;
    for (const std::vector<Traced>& numbers : own) most = std::max(most, numbers.size());
    neighboursAlike(m.bodies(), most, [&](int i, std::size_t k) {
      const std::vector<Traced>& numbers = own[static_cast<std::size_t>(i)];
      return k < numbers.size() ? numbers[k] : Traced();
    });
  }

 private:
  static constexpr int reached = 1 << 24, down = 2 << 24, along = 3 << 24;

  static constexpr std::array<int, strip_lanes> nobody{-1, -1, -1, -1};

  /// Of `count` items, which have `numbers` each.
  template <class NumberOf>
  void neighboursAlike(int count, std::size_t numbers, NumberOf&& numberOf) const {
    if (!limbs.abreast) return;
    for (int first = count % most_abreast - most_abreast; first < count; first += most_abreast)
      for (std::size_t k = 0; k < numbers; ++k) {
        std::array<Traced, most_abreast> neighbours;
        for (int l = std::max(-first, 0); l < most_abreast; ++l) neighbours[static_cast<std::size_t>(l)] = numberOf(first + l, k);
        limbs.builder->alike(neighbours);
      }
  }
  /// choose(dof, isOpen): which go along with dof, by lane, of those that are open yet.
  template <class Use, class Choose>
  void eachTogether(int first, int end, Use&& use, Choose&& choose) const {
    GraphBuilder& builder = *limbs.builder;
    if (builder.inRun() || !limbs.abreast) {
      for (int dof = first; dof < end; ++dof) {
        builder.step(along + dof - first);
        use(dof);
      }
      return;
    }
    std::vector<char> done(static_cast<std::size_t>(end), 0);
    for (int dof = first; dof < end; ++dof) {
      if (done[static_cast<std::size_t>(dof)]) continue;
      const std::array<int, strip_lanes> dofs =
          choose(dof, [&](int other) { return other >= first && other < end && !done[static_cast<std::size_t>(other)]; });
      builder.abreast([&] {
        for (int l = 0; l < strip_lanes; ++l) {
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
  /// Of dof and those that follow it the ones up to where lanes begin again, which they do such that the last ones, far from the root, fill them.
  template <class May>
  std::array<int, strip_lanes> neighboursOf(int dof, May&& may) const {
    std::array<int, strip_lanes> dofs = nobody;
    const int lane = (dof + strip_lanes - m.nvx % strip_lanes) % strip_lanes;
    for (int l = lane; l < strip_lanes; ++l)
      if (const int other = dof - lane + l; may(other)) dofs[static_cast<std::size_t>(l)] = other;
    return dofs;
  }
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
        visiting_ = true;
        visit(Joint(slot), i);
        visiting_ = false;
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
  mutable bool visiting_ = false;
};

template <>
struct OrderOf<Traced> {
  using type = TracedBodies;
  static type over(const CompactImpl& m, Workspace<Traced>& w) { return {m, w, *static_cast<TracedWorkspace&>(w).limbs}; }
};

}  // namespace kernels
}  // namespace dyn
