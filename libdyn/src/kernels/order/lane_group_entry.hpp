// SPDX-License-Identifier: BSD-2-Clause
// Writes the mass matrix, the rows of four joints at a time.
#pragma once

#include "kernels/order/root_paths.hpp"

namespace dyn::kernels {

/// The rows of the mass matrix of a lane group's joints, and their root paths.
template <class S>
class LaneGroupEntry {
 public:
  LaneGroupEntry(const CompactImpl& m, double* M, int i) : paths_(m, i), n_(m.nvx) {
    const auto here = paths_.here();
    for (int l = 0; l < group_lanes; ++l) {
      row_[l] = M + here.dof(l, 0);
      column_[l] = M + here.row(l, 0);
    }
  }
  void enter(int k, int l, const S& value) const { enterAt(paths_.here(), k, l, value); }
  /// Calls use(put). put(k, l, value) enters values for two degrees of freedom k and l of each joint itself.
  template <class Use>
  void enterOwn(Use&& use) const {
    const auto here = paths_.here();
    inEnteringLanes(here, [&](auto lane) {
      double* const block = column_[lane] + here.dof(lane, 0);
      use([&](int k, int l, const S& value) { block[k * n_ + l] = block[k + l * n_] = laneOf<lane>(value); });
    });
  }
  /// Calls use(step) for each step of each root path that some of the joints share, and begin() before each path but the first.
  template <class Begin, class Use, class Turning>
  void climb(Begin&& begin, Use&& use, Turning&&) const {
    bool first = true;
    paths_.each([&](auto&& climb) {
      if (!std::exchange(first, false)) begin();
      climb([&](const auto& step) { use(Entering<std::remove_cvref_t<decltype(step)>>{*this, step}); });
    });
  }

 private:
  template <class Step>
  void enterAt(const Step& step, int k, int l, const S& value) const {
    inEnteringLanes(step, [&](auto lane) { column_[lane][k * n_ + step.dof(lane, l)] = row_[lane][k + step.row(lane, l)] = laneOf<lane>(value); });
  }
  template <class Step>
  struct Entering {
    const LaneGroupEntry& entry;
    const Step& step;
    bool hasOffset() const { return true; }
    decltype(auto) offset(const Vec3<S>* r) const { return step.left(r); }
    int nv() const { return step.nv(); }
    bool floatingBase() const { return step.floatingBase(); }
    bool turnsOnly() const { return step.turnsOnly(); }
    decltype(auto) column(const Workspace<S>& w, int l) const {
      return step.reached(w.dof, l, [](const DofFactor<S>& dof) -> const Motion<S>& { return dof.column; });
    }
    void enter(int k, int l, const S& value) const { entry.enterAt(step, k, l, value); }
    /// Enters only the entries above the diagonal, which are six consecutive numbers. mirrorFloatingBases() copies them below the diagonal.
    void enterFloatingBase(int k, const Force<S>& f) const {
      putSixes(step, f, [&](int lane) { return entry.column_[lane] + k * entry.n_ + step.dof(lane, 0); });
    }
  };

  RootPaths<S> paths_;
  std::ptrdiff_t n_;
  double *row_[group_lanes], *column_[group_lanes];  ///< of each joint's first degree of freedom
};

}  // namespace dyn::kernels
