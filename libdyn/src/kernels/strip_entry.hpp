// Where the mass matrix is written, four joints' rows at a time.
#pragma once

#include "kernels/strip_way.hpp"

namespace dyn::kernels {

/// Four joints' rows of the mass matrix, and their ways up to the root.
template <class S>
class StripEntry {
 public:
  StripEntry(const CompactImpl& m, double* M, int i) : way_(m, i), n_(m.nvx) {
    const auto here = way_.here();
    for (int l = 0; l < strip_lanes; ++l) {
      row_[l] = M + here.dof(l, 0);
      column_[l] = M + here.row(l, 0);
    }
  }
  void enter(int k, int l, const S& value) const { enterAt(way_.here(), k, l, value); }
  /// Calls use(put), and put(k, l, value) enters numbers of the joints' own.
  template <class Use>
  void enterOwn(Use&& use) const {
    const auto here = way_.here();
    inEnteringLanes(here, [&](auto lane) {
      double* const block = column_[lane] + here.dof(lane, 0);
      use([&](int k, int l, const S& value) { block[k * n_ + l] = block[k + l * n_] = laneOf<lane>(value); });
    });
  }
  /// Calls use(step) for each step of each way that some of them go, and begin() before each but the first.
  template <class Begin, class Use, class Turning>
  void climb(Begin&& begin, Use&& use, Turning&&) const {
    bool first = true;
    way_.each([&](auto&& climb) {
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
    const StripEntry& entry;
    const Step& step;
    bool hasLever() const { return true; }
    decltype(auto) lever(const Vec3<S>* r) const { return step.left(r); }
    int nv() const { return step.nv(); }
    bool flyingRoot() const { return step.flyingRoot(); }
    bool turnsOnly() const { return step.turnsOnly(); }
    decltype(auto) column(const Workspace<S>& w, int l) const {
      return step.reached(w.dof, l, [](const DofFactor<S>& dof) -> const Motion<S>& { return dof.S_; });
    }
    void enter(int k, int l, const S& value) const { entry.enterAt(step, k, l, value); }
    /// Above the diagonal, where six numbers follow one another.
    void enterFlying(int k, const Force<S>& f) const {
      putSixes(step, f, [&](int lane) { return entry.column_[lane] + k * entry.n_ + step.dof(lane, 0); });
    }
  };

  StripWay<S> way_;
  std::ptrdiff_t n_;
  double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom
};

}  // namespace dyn::kernels
