// SPDX-License-Identifier: BSD-2-Clause
// The derivative of inverse dynamics by the bodies' inertial parameters.
//
// The power of a body's UnitForces along the motion of a degree of freedom on its root path gives ten entries of its row. Motions of neighbouring
// degrees of freedom lie side by side, in world axes about the origin of the root of their tree; the base's distance from the world's origin does not
// enter. They turn into the body's axes and write their entries in packs. Each body's ten columns are contiguous, so no store is scattered.
#pragma once

#include "kernels/body/regressor_memory.hpp"
#include "kernels/body/unit_forces.hpp"
#include "kernels/order/subtree.hpp"
#include "kernels/recursion/kinematics.hpp"

#include <bit>
#include <limits>

namespace dyn::kernels {

/// Writes x.motions, x.place, and to w.origin the classical acceleration of each body's origin less gravity, in world axes. It reads placements,
/// velocities and accelerations.
template <class Order>
void regressorMotions(const Order& bodies, Workspace<double>& w, const TorqueRegressorMemory& x) {
  bodies.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    const Mat3<double>& R = w.oM[i].R;
    Vec3<double> place{}, acceleration = -bodies.gravity();
    if (!bodies.isRoot(i)) {
      const int p = bodies.parentOf(i);
      place = x.place[p] + w.oM[p].R * w.rel[i].p;
      acceleration = w.origin[p] + w.oM[p].R * beyondOrigin(w.a[p].angular, w.v[p].angular, w.rel[i].p);
    }
    if constexpr (!Joint::about_z) acceleration += R * w.sliding[i];
    x.place[i] = place;
    w.origin[i] = acceleration;
    for (int k = 0; k < nvOf(joint); ++k) {
      const Motion<double> s = joint.columnIn(R, k);
      const Vec3<double> linear = s.linear + cross(place, s.angular);
      for (int c = 0; c < 3; ++c) {
        x.motions[c][iv + k] = linear[c];
        x.motions[3 + c][iv + k] = s.angular[c];
      }
    }
  });
}

/// Degrees of freedom in the lanes of a pack, of which some are on a root path.
template <class Wide>
class LanesOnPath {
 public:
  static constexpr int width = lanes_of<Wide>;
  /// Those on the root path of degree of freedom `last`, among `width` ones from `first` on.
  LanesOnPath(const TorqueRegressorMemory& x, int first, int last) {
    if constexpr (width > 1) on_ = (Wide::load(x.own + first).x <= Wide(last).x) & (Wide::load(x.end + first).x > Wide(last).x);
  }
  /// x on the path and zero elsewhere, whatever x is there. A single degree of freedom is on the path.
  Wide only(const Wide& x) const {
    if constexpr (width == 1) {
      return x;
    } else {
      return std::bit_cast<typename Wide::Native>(std::bit_cast<Bits>(x.x) & on_);
    }
  }

 private:
  using Bits = typename Square<std::int64_t, width>::Row;
  Bits on_{};
};

/// Calls use(first) for packs of degrees of freedom, from `first` on each, that cover the root path of `last`. The last pack ends with degree of
/// freedom n - 1 unless it is the first as well.
template <int width, class Use>
void packsOnPath(const CompactImpl& m, int last, Use&& use) {
  const int last_first = std::max(m.nvx - width, 0);
  int begin = m.dof_segment[static_cast<std::size_t>(last)];
  // One loop, so that compilers do what does not change in it once.
  for (int pack = last / width;;) {
    use(std::min(pack * width, last_first));
    --pack;
    while (pack < begin / width) {
      const int next = m.dof_parent[static_cast<std::size_t>(begin)];
      if (next < 0) return;
      begin = m.dof_segment[static_cast<std::size_t>(next)];
      pack = std::min(pack, next / width);
    }
  }
}

/// Writes the entries on root paths, and a few zeros beside them, to `out`: nvx rows, ten columns for each of the user's joints, and room for a pack.
/// Other entries must be zero before, and stay so. It reads what regressorMotions() reads and writes.
template <class Wide>
__attribute__((flatten)) void torqueRegressor(const CompactImpl& m, const Workspace<double>& w, const TorqueRegressorMemory& x, double* out) {
  const std::ptrdiff_t rows = m.nvx;
  for (std::size_t j = 1; j < m.joints.size(); ++j, out += 10 * rows) {
    if (!carriesBody(m, static_cast<int>(j))) continue;
    const int i = m.body_of_joint[j];
    const SE3<double>& frame = m.user_frame[j];
    const Mat3<double>&body = w.oM[i].R, R = body * frame.R;
    const Vec3<double>&w_body = w.v[i].angular, &dw_body = w.a[i].angular;
    const Vec3<double> origin = transposeTimes(R, w.origin[i] + body * beyondOrigin(dw_body, w_body, frame.p));
    const UnitForces forces(origin, transposeTimes(frame.R, w_body), transposeTimes(frame.R, dw_body));
    const Vec3<double> place = x.place[i] + body * frame.p;
    const Vec3<Wide> point{Wide(place.x), Wide(place.y), Wide(place.z)};
    Mat3<Wide> axes;
    for (int k = 0; k < 9; ++k) axes.m[k] = Wide(R.m[k]);
    const BodyIndex& index = m.index[static_cast<std::size_t>(i)];
    const int last = index.idx_v + index.nv - 1;
    packsOnPath<lanes_of<Wide>>(m, last, [&](int first) {
      const auto three = [&](int c) {
        return Vec3<Wide>{loadPack<Wide>(x.motions[c] + first), loadPack<Wide>(x.motions[c + 1] + first), loadPack<Wide>(x.motions[c + 2] + first)};
      };
      const Vec3<Wide> angular = three(3);
      const LanesOnPath<Wide> path(x, first, last);
      forces.along(Motion<Wide>{transposeTimes(axes, three(0) + cross(angular, point)), transposeTimes(axes, angular)},
                   [&](int k, const Wide& power) { storePack(path.only(power), out + k * rows + first); });
    });
  }
}

}  // namespace dyn::kernels
