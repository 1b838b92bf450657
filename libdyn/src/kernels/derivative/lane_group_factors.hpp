// SPDX-License-Identifier: BSD-2-Clause
// The factors of M^-1 over lane groups: the forces of four joints go to the root together.
#pragma once

#include "kernels/derivative/lane_group_paths.hpp"
#include "kernels/derivative/path_sweep.hpp"

namespace dyn::kernels {

/// factorsSweep for a recursion over lane groups.
template <class S>
void laneGroupFactorsSweep(const LaneGroupRecursion<S>& r, const Rows<double> U) {
  const LaneGroupDofs<S> dofs{r.order.w, r.d};
  const auto rowOf = [&](const auto& step, int l) -> decltype(auto) {
    return step.reached(r.d.dof_force, l, [](const DofForces<S>& dof) -> const Force<S>& { return dof.by_a; });
  };
  r.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    const RootPaths<S> way(r.order.m, i);
    const auto here = way.here();
    for (int c = 0; c < nvOf<Joint>(r.order, i); ++c) {
      double* column[group_lanes];
      for (int lane = 0; lane < group_lanes; ++lane) column[lane] = U.first + here.dof(lane, c);
      const auto enter = [&](const auto& step, int l, const S& u) {
        inEnteringLanes(step, [&](auto lane) { column[lane][step.dof(lane, l) * U.stride] = laneOf<lane>(u); });
      };
      // Projects out the first `count` degrees of freedom of a joint, the last of them first.
      const auto projectOut = [&](const auto& step, int count, Force<S>& f) {
        const auto oneByOne = [&](auto&& projection) {
          for (int l = count - 1; l >= 0; --l) {
            const S u = projection(l);
            enter(step, l, u);
            project_out(f, rowOf(step, l), u);
          }
        };
        if (step.floatingBase()) {
#pragma GCC unroll 6
          for (int l = 5; l >= 0; --l) {
            if (l >= count) continue;
            const S u = axisOf(f, l);
            enter(step, l, u);
            projectOutBefore(l, f, rowOf(step, l), u);
          }
        } else if (step.turnsOnly()) {
          oneByOne([&](int l) { return along<true>(dofs.column(step, l), f); });
        } else {
          oneByOne([&](int l) { return along<false>(dofs.column(step, l), f); });
        }
      };
      Force<S> own = r.d.dof_force[iv + c].by_a;
      enter(here, c, S(-1));
      projectOut(here, c, own);
      way.each([&](auto&& climb) {
        Force<S> f = own;
        climb([&](const auto& step) {
          addCross(f.angular, step.left(r.order.w.r), f.linear);
          projectOut(step, step.nv(), f);
        });
      });
    }
  });
}

}  // namespace dyn::kernels
