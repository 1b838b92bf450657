// SPDX-License-Identifier: BSD-2-Clause
// The entries of the derivatives of inverse dynamics over lane groups: the forces of four joints go to the root together.
#pragma once

#include "kernels/derivative/recursion.hpp"
#include "kernels/order/root_paths.hpp"

namespace dyn::kernels {

/// The projection of a force on a column. turns: the joint only turns.
template <bool turns, class S>
S along(const Motion<S>& column, const Force<S>& f) {
  return turns ? dot(column.angular, f.angular) : dot(column, f);
}

/// The results of recursions over lane groups for the bodies and degrees of freedom that the lanes have reached.
template <class S>
struct LaneGroupDofs {
  const Workspace<S>& w;
  const DerivativeWorkspace<S>& d;

  template <class Step>
  decltype(auto) column(const Step& step, int l) const {
    return step.reached(w.dof, l, [](const DofFactor<S>& dof) -> const Motion<S>& { return dof.column; });
  }
  /// One of the motions of the variation of the l-th degree of freedom.
  template <class Step>
  decltype(auto) variation(const Step& step, int l, Motion<S> DofVariation<S>::*motion) const {
    return step.reached(d.dof, l, [&](const DofVariation<S>& x) -> const Motion<S>& { return x.*motion; });
  }
  /// (12) of rnea_derivatives.hpp for the l-th degree of freedom.
  template <bool turns, class Step>
  LowerEntries<S> below(const Step& step, int l, const Motion<S>& s, const DofForces<S>& f) const {
    using Variation = DofVariation<S>;
    const Force<S>& U = f.by_a;
    const Motion<S>& velocity = variation(step, l, &Variation::velocity);
    const Motion<S>& acceleration = variation(step, l, &Variation::acceleration);
    const Motion<S>& rate = variation(step, l, &Variation::rate);
    LowerEntries<S> x{dot(acceleration, U) + dot(velocity.angular, f.offset), dot(rate.angular, U.angular) + dot(s.angular, f.offset)};
    if constexpr (!turns) x.v += dot(rate.linear, U.linear);
    return x;
  }
  /// The same for a floating base, whose columns are the axes and whose parent, the world, is at rest.
  template <class Step>
  LowerEntries<S> belowFloatingBase(const Step& step, int l, const DofForces<S>& f) const {
    using Variation = DofVariation<S>;
    const Force<S>& U = f.by_a;
    const Motion<S>& rate = variation(step, l, &Variation::rate);
    if (l < 3) return {S(0), dot(rate.linear, U.linear)};
    return {dot(variation(step, l, &Variation::acceleration).linear, U.linear), dot(rate, U) + f.offset[l - 3]};
  }
};

/// Enters the derivatives for four joints, one in each lane, with themselves and with the joints on their root paths.
template <class S, bool with_M>
class LaneGroupPaths {
 public:
  LaneGroupPaths(const CompactImpl& m, const PathDerivatives& out, const Workspace<S>& w, const DerivativeWorkspace<S>& d, int i)
      : paths_(m, i), dofs_{w, d}, out_(out), n_(m.nvx) {}

  /// All entries of the joints' c-th degrees of freedom, of nv. `forces`: their forces about the joints' own origins.
  void enter(int c, const DofForces<S>& forces, int nv) {
    const auto here = paths_.here();
    for (int lane = 0; lane < group_lanes; ++lane) {
      row_[lane] = here.dof(lane, c);
      column_[lane] = here.row(lane, c);
    }
    if (here.floatingBase()) {
      enterBelowFloatingBase(here, forces);
    } else {
      for (int l = 0; l < nv; ++l) enterOwn(here, l, forces);
    }
    paths_.each([&](auto&& climb) { climbWith(forces, climb); });
  }

 private:
  template <class Climb>
  void climbWith(DofForces<S> f, Climb&& climb) const {
    climb([&](const auto& step) {
      const Vec3<S>& r = step.left(dofs_.w.r);
      addCross(f.offset, S(2) * step.left(dofs_.d.shift_rate), f.by_a.linear);
      for (Force<S>* force : {&f.by_a, &f.by_q, &f.by_v}) addCross(force->angular, r, force->linear);
      if (step.floatingBase()) {
        enterBelowFloatingBase(step, f);
        const auto sixes = [&](const Force<S>& six, double* matrix) {
          putSixes(step, six, [&](int lane) { return matrix + column_[lane] + step.dof(lane, 0); });
        };
        if constexpr (with_M) sixes(f.by_a, out_.by_a);
        sixes(f.by_q, out_.by_q);
        sixes(f.by_v, out_.by_v);
      } else if (step.turnsOnly()) {
        for (int l = 0; l < step.nv(); ++l) enterBoth<true>(step, l, f);
      } else {
        for (int l = 0; l < step.nv(); ++l) enterBoth<false>(step, l, f);
      }
    });
  }

  /// Entries within a joint, where nothing turns.
  template <class Step>
  void enterOwn(const Step& step, int l, const DofForces<S>& f) const {
    const Motion<S>& column = dofs_.column(step, l);
    const LowerEntries<S> x = dofs_.template below<false>(step, l, column, f);
    const S a = with_M ? dot(column, f.by_a) : S(0);
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t place = step.row(lane, l) + row_[lane];
      out_.by_q[place] = laneOf<lane>(x.q);
      out_.by_v[place] = laneOf<lane>(x.v);
      if constexpr (with_M) out_.by_a[place] = laneOf<lane>(a);
    });
  }
  template <bool turns, class Step>
  void enterBoth(const Step& step, int l, const DofForces<S>& f) const {
    const Motion<S>& column = dofs_.column(step, l);
    const LowerEntries<S> x = dofs_.template below<turns>(step, l, column, f);
    const S q = along<turns>(column, f.by_q), v = along<turns>(column, f.by_v), a = with_M ? along<turns>(column, f.by_a) : S(0);
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t place = step.row(lane, l) + row_[lane], mirrored = column_[lane] + step.dof(lane, l);
      out_.by_q[place] = laneOf<lane>(x.q);
      out_.by_v[place] = laneOf<lane>(x.v);
      out_.by_q[mirrored] = laneOf<lane>(q);
      out_.by_v[mirrored] = laneOf<lane>(v);
      if constexpr (with_M) out_.by_a[place] = out_.by_a[mirrored] = laneOf<lane>(a);
    });
  }
  /// Lower entries with a floating base. Translating the base changes no force, so those entries of by_q stay zero.
  template <class Step>
  void enterBelowFloatingBase(const Step& step, const DofForces<S>& f) const {
    LowerEntries<S> x[6];
    for (int l = 0; l < 6; ++l) x[l] = dofs_.belowFloatingBase(step, l, f);
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t place = step.row(lane, 0) + row_[lane];
      for (int l = 3; l < 6; ++l) out_.by_q[place + l * n_] = laneOf<lane>(x[l].q);
      for (int l = 0; l < 6; ++l) out_.by_v[place + l * n_] = laneOf<lane>(x[l].v);
      if constexpr (with_M)
        for (int l = 0; l < 6; ++l) out_.by_a[place + l * n_] = laneOf<lane>(UnitColumn<S>{l}.along(f.by_a));
    });
  }

  RootPaths<S> paths_;
  LaneGroupDofs<S> dofs_;
  const PathDerivatives out_;
  const std::ptrdiff_t n_;
  std::ptrdiff_t row_[group_lanes], column_[group_lanes];  ///< the degrees of freedom that are being entered, and where their columns begin
};

/// pathSweep for a recursion over lane groups, into the output matrices.
template <class S>
void laneGroupPathSweep(const LaneGroupRecursion<S>& r, const PathDerivatives& out) {
  const auto sweep = [&](auto with_M) {
    r.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
      LaneGroupPaths<S, with_M> paths(r.order.m, out, r.order.w, r.d, i);
      const int nv = nvOf<Joint>(r.order, i);
      for (int c = 0; c < nv; ++c) paths.enter(c, r.d.dof_force[iv + c], nv);
    });
  };
  if (out.by_a) {
    sweep(std::true_type());
  } else {
    sweep(std::false_type());
  }
}

}  // namespace dyn::kernels
