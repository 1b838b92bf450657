// Where the mass matrix is written, four joints' rows at a time.
#pragma once

#include "kernels/strip_way.hpp"

namespace dyn::kernels {

/// Four joints' rows of the mass matrix, and their ways up to the root.
template <class S>
class StripEntry {
 public:
  StripEntry(const CompactImpl& m, double* M, int i) : way_(m, i), n_(m.nvx) {
    for (int l = 0; l < strip_lanes; ++l) {
      const std::ptrdiff_t dof = way_.here().dof(l, 0);
      row_[l] = M + dof;
      column_[l] = M + dof * n_;
    }
  }
  void enter(int k, int l, const S& value) const { enterAt(way_.here(), k, l, value); }
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
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t j = step.dof(lane, l);
      column_[lane][k * n_ + j] = row_[lane][k + j * n_] = laneOf<lane>(value);
    });
  }
  template <class Step>
  struct Entering {
    const StripEntry& entry;
    const Step& step;
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
      putSixes(f, [&](int lane) { return step.enters(lane) ? entry.column_[lane] + k * entry.n_ + step.dof(lane, 0) : nullptr; });
    }
  };

  StripWay<S> way_;
  std::ptrdiff_t n_;
  double *row_[strip_lanes], *column_[strip_lanes];  ///< of the joint's first degree of freedom
};

}  // namespace dyn::kernels
