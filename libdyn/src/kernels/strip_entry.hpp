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
  StripEntry(const CompactImpl& m, double* M, int i, int iv) : m_(m), plan_(m.strips), n_(m.nvx), strip_(&plan_.strips[index(i)]) {
    for (int l = 0; l < strip_lanes; ++l) {
      const std::ptrdiff_t dof = plan_.dof_index[index(strip_lanes * iv + l)];
      row_[l] = strip_->body[l] < 0 ? nullptr : M + dof;
      column_[l] = M + dof * n_;
    }
  }
  void enter(int k, int l, const S& value) const { Together{*this, strip_, strip_}.enter(k, l, value); }
  /// Strip by strip while lanes go on as they are, else body by body. Lanes are seldom in pieces of one length.
  template <class Step, class Turning>
  void climb(Step&& use, Turning&&) const {
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
    const Vec3<S>& lever(const Vec3<S>* r) const { return r[from_ - entry_.plan_.strips.data()]; }
    int nv() const { return to_->nv; }
    bool flyingRoot() const { return to_->shape == Shape::free && to_->depth == 1; }
    bool turnsOnly() const { return dyn::turnsOnly(to_->shape); }
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
    Apart(const StripEntry& entry, const Strip& strip)
        : entry_(entry), index_(entry.m_.index.data()), seats_(entry.plan_.seats.data()), depth_(strip.depth) {
      for (int l = 0; l < strip_lanes; ++l) to_[l] = std::max(strip.shown[l], 0);
    }
    bool climb() {
      if (depth_ == 1) return false;
      for (int l = 0; l < strip_lanes; ++l) {
        const bool climbs = index_[to_[l]].depth == depth_;
        from_[l] = climbs ? to_[l] : 0;
        to_[l] = climbs ? index_[to_[l]].parent : to_[l];
        entries_[l] = climbs && entry_.row_[l] != nullptr ? index_[to_[l]].nv : 0;
      }
      --depth_;
      return true;
    }
    /// The universe's zero in lanes that stay where they are.
    Vec3<S> lever(const Vec3<S>* r) const {
      return gather<Vec3<S>>(from_, [&](const Seat& seat, int) -> const Vec3<S>& { return r[seat.strip]; });
    }
    int nv() const { return std::max(std::max(entries_[0], entries_[1]), std::max(entries_[2], entries_[3])); }
    bool flyingRoot() const {
      return all([](const BodyIndex& x) { return x.flying_root; });
    }
    bool turnsOnly() const {
      return all([](const BodyIndex& x) { return x.turns_only; });
    }
    Motion<S> column(const Workspace<S>& workspace, int l) const {
      return gather<Motion<S>>(
          to_, [&](const Seat& seat, int nv) -> const Motion<S>& { return workspace.dof[seat.strip_dof + std::max(std::min(l, nv - 1), 0)].S_; });
    }
    void enter(int k, int l, const S& value) const {
      for (int lane = 0; lane < strip_lanes; ++lane)
        if (l < entries_[lane]) entry_.put(lane, k, index_[to_[lane]].idx_v + l, value.begin()[lane]);
    }
    void enterFlying(int k, const Force<S>& f) const {
      entry_.putFlying(k, f, [&](int lane) { return entries_[lane] == 0 ? -1 : index_[to_[lane]].idx_v; });
    }

   private:
    /// of(seat, nv): where the arrays have the struct of which such a body has one lane.
    template <class T, class Of>
    T gather(const int* body, Of&& of) const {
      const double* first[strip_lanes];
      for (int l = 0; l < strip_lanes; ++l) {
        const Seat& seat = seats_[body[l]];
        first[l] = reinterpret_cast<const double*>(&of(seat, index_[body[l]].nv)) + seat.lane;
      }
      return gatheredLanes<S, T>(first);
    }
    template <class Test>
    bool all(Test&& test) const {
      bool holds = true;
      for (int l = 0; l < strip_lanes; ++l) holds = holds && (entries_[l] == 0 || test(index_[to_[l]]));
      return holds;
    }
    const StripEntry& entry_;
    const BodyIndex* index_;
    const Seat* seats_;
    int depth_;
    int from_[strip_lanes], to_[strip_lanes];  ///< bodies
    int entries_[strip_lanes];                 ///< degrees of freedom of the body that the lane has come to; zero if it has no row or has not moved
  };

  const CompactImpl& m_;
  const StripPlan& plan_;
  std::ptrdiff_t n_;
  const Strip* strip_;
  double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom; null rows: lanes without a body
};

}  // namespace dyn::kernels
