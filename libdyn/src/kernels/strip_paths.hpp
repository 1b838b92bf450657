// Entries of matrices from forces that climb to the root, four joints' at a time: derivatives of inverse dynamics, factors of M.
#pragma once

#include "kernels/recursion.hpp"
#include "kernels/strip_way.hpp"

namespace dyn::kernels {

/// Of four joints, one in each lane: entries of the derivatives for them and for those on their ways to the root.
template <class S, bool with_M>
class StripPaths {
 public:
  StripPaths(const CompactImpl& m, const PathDerivatives& out, const Workspace<S>& w, const DerivativeWorkspace<S>& d, int i)
      : way_(m, i), out_(out), n_(m.nvx), w_(w), d_(d) {}

  /// All of their c-th degrees of freedom, of nv, whose forces about the joints' own origins these are.
  void enter(int c, const DofForces<S>& forces, int nv) {
    const auto here = way_.here();
    for (int lane = 0; lane < strip_lanes; ++lane) row_[lane] = here.dof(lane, c);
    if (here.flyingRoot()) {
      enterUnderFlying(here, forces);
    } else {
      for (int l = 0; l < nv; ++l) enterOwn(here, l, forces);
    }
    way_.each([&](auto&& climb) { climbWith(forces, climb); });
  }

 private:
  template <class Climb>
  void climbWith(DofForces<S> f, Climb&& climb) const {
    climb([&](const auto& step) {
      const Vec3<S>& r = step.left(w_.r);
      const Vec3<S> rate = S(2) * step.left(d_.shift_rate);
      f.by_a.angular += cross(r, f.by_a.linear);
      f.lever += cross(rate, f.by_a.linear);
      f.by_q.angular += cross(r, f.by_q.linear);
      f.by_v.angular += cross(r, f.by_v.linear);
      if (step.flyingRoot()) {
        enterUnderFlying(step, f);
        const auto sixes = [&](const Force<S>& six, double* matrix) {
          putSixes(six, [&](int lane) { return step.enters(lane) ? matrix + row_[lane] * n_ + step.dof(lane, 0) : nullptr; });
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

  template <class Step>
  decltype(auto) columnOf(const Step& step, int l) const {
    return step.reached(w_.dof, l, [](const DofFactor<S>& dof) -> const Motion<S>& { return dof.S_; });
  }
  /// One of the motions of a variation.
  template <class Step>
  decltype(auto) variationOf(const Step& step, int l, Motion<S> DofVariation<S>::*motion) const {
    return step.reached(d_.dof, l, [&](const DofVariation<S>& x) -> const Motion<S>& { return x.*motion; });
  }
  /// What variations of others make of forces, and their entry of M.
  struct Below {
    S q, v, a;
  };
  template <bool turns, class Step>
  Below below(const Step& step, int l, const Motion<S>& column, const DofForces<S>& f) const {
    using Variation = DofVariation<S>;
    const Motion<S>& velocity = variationOf(step, l, &Variation::velocity);
    const Motion<S>& acceleration = variationOf(step, l, &Variation::acceleration);
    const Motion<S>& rate = variationOf(step, l, &Variation::rate);
    const Force<S>& U = f.by_a;
    Below x{dot(acceleration, U) + dot(velocity.angular, f.lever), dot(rate.angular, U.angular) + dot(column.angular, f.lever), S(0)};
    if constexpr (!turns) x.v += dot(rate.linear, U.linear);
    if constexpr (with_M) {
      x.a = dot(column.angular, U.angular);
      if constexpr (!turns) x.a += dot(column.linear, U.linear);
    }
    return x;
  }
  /// Within a joint, where nothing turns.
  template <class Step>
  void enterOwn(const Step& step, int l, const DofForces<S>& f) const {
    const Below x = below<false>(step, l, columnOf(step, l), f);
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t place = step.dof(lane, l) * n_ + row_[lane];
      out_.by_q[place] = laneOf<lane>(x.q);
      out_.by_v[place] = laneOf<lane>(x.v);
      if constexpr (with_M) out_.by_a[place] = laneOf<lane>(x.a);
    });
  }
  template <bool turns, class Step>
  void enterBoth(const Step& step, int l, const DofForces<S>& f) const {
    const Motion<S>& column = columnOf(step, l);
    const Below x = below<turns>(step, l, column, f);
    S q = dot(column.angular, f.by_q.angular), v = dot(column.angular, f.by_v.angular);
    if constexpr (!turns) {
      q += dot(column.linear, f.by_q.linear);
      v += dot(column.linear, f.by_v.linear);
    }
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t k = step.dof(lane, l), j = row_[lane], place = k * n_ + j, mirrored = j * n_ + k;
      out_.by_q[place] = laneOf<lane>(x.q);
      out_.by_v[place] = laneOf<lane>(x.v);
      out_.by_q[mirrored] = laneOf<lane>(q);
      out_.by_v[mirrored] = laneOf<lane>(v);
      if constexpr (with_M) out_.by_a[place] = out_.by_a[mirrored] = laneOf<lane>(x.a);
    });
  }
  /// Under a flying root, whose columns are the axes and which nothing moves before. Its way of going straight ahead is nothing to forces: zeros
  /// stay.
  template <class Step>
  void enterUnderFlying(const Step& step, const DofForces<S>& f) const {
    using Variation = DofVariation<S>;
    const Force<S>& U = f.by_a;
    S q[3], v[6];
    for (int l = 0; l < 3; ++l) {
      const Motion<S>&slide = variationOf(step, l, &Variation::rate), &turn = variationOf(step, 3 + l, &Variation::rate);
      const Motion<S>& accelerated = variationOf(step, 3 + l, &Variation::acceleration);
      q[l] = dot(accelerated.linear, U.linear);
      v[l] = dot(slide.linear, U.linear);
      v[3 + l] = dot(turn, U) + f.lever[l];
    }
    inEnteringLanes(step, [&](auto lane) {
      const std::ptrdiff_t place = step.dof(lane, 0) * n_ + row_[lane];
      for (int l = 0; l < 3; ++l) out_.by_q[place + (3 + l) * n_] = laneOf<lane>(q[l]);
      for (int l = 0; l < 6; ++l) out_.by_v[place + l * n_] = laneOf<lane>(v[l]);
      if constexpr (with_M)
        for (int l = 0; l < 6; ++l) out_.by_a[place + l * n_] = laneOf<lane>(l < 3 ? U.linear[l] : U.angular[l - 3]);
    });
  }

  StripWay<S> way_;
  const PathDerivatives out_;
  const std::ptrdiff_t n_;
  const Workspace<S>& w_;
  const DerivativeWorkspace<S>& d_;
  std::ptrdiff_t row_[strip_lanes];  ///< the degrees of freedom that are being entered
};

/// pathSweep of a recursion over strips, into place.
template <class S>
void stripPathSweep(const StripRecursion<S>& r, const PathDerivatives& out) {
  const auto sweep = [&](auto with_M) {
    r.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
      StripPaths<S, with_M> paths(r.order.m, out, r.order.w, r.d, i);
      for (int c = 0; c < Joint::nv; ++c) paths.enter(c, r.d.dof_force[iv + c], Joint::nv);
    });
  };
  if (out.by_a) {
    sweep(std::true_type());
  } else {
    sweep(std::false_type());
  }
}

/// factorsSweep of a recursion over strips.
template <class S>
void stripFactorsSweep(const StripRecursion<S>& r, const Rows<double> L) {
  const Workspace<S>& w = r.order.w;
  const auto columnOf = [&](const auto& step, int l) -> decltype(auto) {
    return step.reached(w.dof, l, [](const DofFactor<S>& dof) -> const Motion<S>& { return dof.S_; });
  };
  r.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    const StripWay<S> way(r.order.m, i);
    const auto here = way.here();
    for (int c = 0; c < Joint::nv; ++c) {
      const Force<S>& own = r.d.dof_force[iv + c].by_a;
      const auto enter = [&](const auto& step, int l, const S& x) {
        inEnteringLanes(step, [&](auto lane) { L[static_cast<int>(step.dof(lane, l))][here.dof(lane, c)] = laneOf<lane>(x); });
      };
      const auto enterFlying = [&](const auto& step, const Force<S>& f) {
        for (int l = 0; l < 6; ++l) enter(step, l, l < 3 ? f.linear[l] : f.angular[l - 3]);
      };
      if (here.flyingRoot()) {
        enterFlying(here, own);
      } else {
        for (int l = 0; l < Joint::nv; ++l) enter(here, l, Column<Joint, S>{w.dof[iv + l].S_}.along(own));
      }
      way.each([&](auto&& climb) {
        Force<S> f = own;
        climb([&](const auto& step) {
          f.angular += cross(step.left(w.r), f.linear);
          if (step.flyingRoot()) return enterFlying(step, f);
          if (step.turnsOnly()) {
            for (int l = 0; l < step.nv(); ++l) enter(step, l, dot(columnOf(step, l).angular, f.angular));
          } else {
            for (int l = 0; l < step.nv(); ++l) enter(step, l, dot(columnOf(step, l), f));
          }
        });
      });
    }
  });
}

}  // namespace dyn::kernels
