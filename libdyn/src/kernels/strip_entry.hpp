// Where the mass matrix is written, four joints' rows at a time.
#pragma once

#include "kernels/columns.hpp"
#include "kernels/lanes.hpp"
#include "kernels/workspace.hpp"

#include <algorithm>
#include <utility>

namespace dyn::kernels {

/// Four joints' rows of the mass matrix, and their ways up to the root.
template <class S>
class StripEntry {
 public:
  StripEntry(const CompactImpl& m, double* M, int i, int iv) : plan_(m.strips), n_(m.nvx), strip_(&plan_.strips[index(i)]) {
    for (int l = 0; l < strip_lanes; ++l) {
      const std::ptrdiff_t dof = plan_.dof_index[index(strip_lanes * iv + l)];
      row_[l] = strip_->body[l] < 0 ? nullptr : M + dof;
      column_[l] = M + dof * n_;
    }
  }
  void enter(int k, int l, const S& value) const { Together{*this, strip_, strip_}.enter(k, l, value); }
  /// Strip by strip while lanes go on as they are, else body by body.
  template <class Use>
  void climb(Use&& use) const {
    const Strip* from = strip_;
    while (from->aligned && from->depth > 1) {
      const Strip* to = &plan_.strips[index(from->parents[0].strip)];
      use(Together{*this, from, to});
      from = to;
    }
    if (from->depth > 1)
      for (Apart lanes(*this, *from); lanes.climb();) use(std::as_const(lanes));
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  void put(int lane, int k, std::ptrdiff_t j, double number) const { column_[lane][k * n_ + j] = row_[lane][k + j * n_] = number; }
  /// Above the diagonal, where six numbers follow one another. dofOf(lane): the root's first, negative where nothing is to be entered.
  template <class DofOf>
  void putFlying(int k, const Force<S>& f, DofOf&& dofOf) const {
    Square<double, strip_lanes> first, last;
    for (int c = 0; c < strip_lanes; ++c) {
      first.read(c, packsOf<S>(f)[c].begin());
      last.read(c, packsOf<S>(f)[c + 2].begin());
    }
    first.transpose();
    last.transpose();
    for (int lane = 0; lane < strip_lanes; ++lane) {
      const std::ptrdiff_t dof = dofOf(lane);
      if (dof < 0) continue;
      double* to = column_[lane] + k * n_ + dof;
      first.write(lane, to);
      last.write(lane, to + 2);
    }
  }

  class Together {
   public:
    Together(const StripEntry& entry, const Strip* from, const Strip* to) : entry_(entry), from_(from), to_(to) {}
    template <class T>
    const T& lever(const T* r) const {
      return r[from_ - entry_.plan_.strips.data()];
    }
    int nv() const { return to_->nv; }
    bool flyingRoot() const { return to_->flying_root; }
    bool turnsOnly() const { return to_->turns_only; }
    const Motion<S>& column(const Workspace<S>& workspace, int l) const { return workspace.dof[to_->dof + l].S_; }
    void enter(int k, int l, const S& value) const {
      const std::int64_t* other = entry_.plan_.dof_index.data() + strip_lanes * (to_->dof + l);
      for (int lane = 0; lane < strip_lanes; ++lane)
        if (entry_.row_[lane] != nullptr) entry_.put(lane, k, other[lane], value.begin()[lane]);
    }
    void enterFlying(int k, const Force<S>& f) const {
      const std::int64_t* other = entry_.plan_.dof_index.data() + strip_lanes * to_->dof;
      entry_.putFlying(k, f, [&](int lane) { return entry_.row_[lane] == nullptr ? -1 : other[lane]; });
    }

   private:
    const StripEntry& entry_;
    const Strip *from_, *to_;
  };

  /// Each lane from body to body, the deepest first, so that all are at the root at once.
  class Apart {
   public:
    Apart(const StripEntry& entry, const Strip& strip) : entry_(entry), seats_(entry.plan_.seats.data()), depth_(strip.depth) {
      for (int l = 0; l < strip_lanes; ++l) to_[l] = seats_ + std::max(strip.shown[l], 0);
    }
    bool climb() {
      if (depth_ == 1) return false;
      for (int l = 0; l < strip_lanes; ++l) {
        const bool climbs = to_[l]->depth == depth_;
        from_[l] = climbs ? to_[l] : seats_;
        to_[l] = climbs ? seats_ + to_[l]->parent : to_[l];
        entries_[l] = climbs && entry_.row_[l] != nullptr ? to_[l]->nv : 0;
      }
      --depth_;
      return true;
    }
    /// Zero in lanes that stay where they are.
    template <class T>
    T lever(const T* r) const {
      return gather<T>([&](int l) { return laneOf(r[from_[l]->strip], *from_[l]); });
    }
    int nv() const { return std::max(std::max(entries_[0], entries_[1]), std::max(entries_[2], entries_[3])); }
    bool flyingRoot() const {
      return all([](const Seat& seat) { return seat.flying_root; });
    }
    bool turnsOnly() const {
      return all([](const Seat& seat) { return seat.turns_only; });
    }
    Motion<S> column(const Workspace<S>& workspace, int l) const {
      return gather<Motion<S>>([&](int lane) { return laneOf(workspace.dof[to_[lane]->strip_dof + std::min(l, to_[lane]->nv - 1)].S_, *to_[lane]); });
    }
    void enter(int k, int l, const S& value) const {
      for (int lane = 0; lane < strip_lanes; ++lane)
        if (l < entries_[lane]) entry_.put(lane, k, to_[lane]->dof + l, value.begin()[lane]);
    }
    void enterFlying(int k, const Force<S>& f) const {
      entry_.putFlying(k, f, [&](int lane) { return entries_[lane] == 0 ? -1 : to_[lane]->dof; });
    }

   private:
    template <class T>
    static const double* laneOf(const T& packs, const Seat& seat) {
      return reinterpret_cast<const double*>(&packs) + seat.lane;
    }
    template <class T, class From>
    static T gather(From&& from) {
      const double* const first[strip_lanes] = {from(0), from(1), from(2), from(3)};
      return gatheredLanes<S, T>(first);
    }
    template <class Test>
    bool all(Test&& test) const {
      bool holds = true;
      for (int l = 0; l < strip_lanes; ++l) holds = holds && (entries_[l] == 0 || test(*to_[l]));
      return holds;
    }
    const StripEntry& entry_;
    const Seat* seats_;
    int depth_;
    const Seat *from_[strip_lanes], *to_[strip_lanes];
    int entries_[strip_lanes];  ///< degrees of freedom of the body that the lane has come to; zero if it has no row or has not moved
  };

  const StripPlan& plan_;
  std::ptrdiff_t n_;
  const Strip* strip_;
  double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom; null rows: lanes without a body
};

}  // namespace dyn::kernels
