// The factors of M^-1 from forces that climb to the root, four joints' at a time.
#pragma once

#include "kernels/path_sweep.hpp"
#include "kernels/strip_paths.hpp"

namespace dyn::kernels {

/// factorsSweep of a recursion over strips.
template <class S>
void stripFactorsSweep(const StripRecursion<S>& r, const Rows<double> U) {
  const StripDofs<S> dofs{r.order.w, r.d};
  const auto rowOf = [&](const auto& step, int l) -> decltype(auto) {
    return step.reached(r.d.dof_force, l, [](const DofForces<S>& dof) -> const Force<S>& { return dof.by_a; });
  };
  r.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    const StripWay<S> way(r.order.m, i);
    const auto here = way.here();
    for (int c = 0; c < nvOf<Joint>(r.order, i); ++c) {
      double* column[strip_lanes];
      for (int lane = 0; lane < strip_lanes; ++lane) column[lane] = U.first + here.dof(lane, c);
      const auto enter = [&](const auto& step, int l, const S& u) {
        inEnteringLanes(step, [&](auto lane) { column[lane][step.dof(lane, l) * U.stride] = laneOf<lane>(u); });
      };
      // The first `count` degrees of freedom of a joint give way, the last of them first.
      const auto giveWay = [&](const auto& step, int count, Force<S>& f) {
        const auto oneByOne = [&](auto&& share) {
          for (int l = count - 1; l >= 0; --l) {
            const S u = share(l);
            enter(step, l, u);
            yield(f, rowOf(step, l), u);
          }
        };
        if (step.flyingRoot()) {
#pragma GCC unroll 6
          for (int l = 5; l >= 0; --l) {
            if (l >= count) continue;
            const S u = axisOf(f, l);
            enter(step, l, u);
            yieldBefore(l, f, rowOf(step, l), u);
          }
        } else if (step.turnsOnly()) {
          oneByOne([&](int l) { return along<true>(dofs.column(step, l), f); });
        } else {
          oneByOne([&](int l) { return along<false>(dofs.column(step, l), f); });
        }
      };
      Force<S> own = r.d.dof_force[iv + c].by_a;
      enter(here, c, S(-1));
      giveWay(here, c, own);
      way.each([&](auto&& climb) {
        Force<S> f = own;
        climb([&](const auto& step) {
          addCross(f.angular, step.left(r.order.w.r), f.linear);
          giveWay(step, step.nv(), f);
        });
      });
    }
  });
}

}  // namespace dyn::kernels
