// SPDX-License-Identifier: BSD-2-Clause
// Linear velocities of joints in axes that rotate with the body.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/lie/so3.hpp>

namespace dyn {

/// The number of first degrees of freedom that are a linear velocity in axes which the joint's other degrees of freedom rotate. 0 for other shapes.
constexpr int slidingAndTurning(Shape shape) { return shape == Shape::free ? 3 : shape == Shape::planar ? 2 : 0; }

/// Moves the linear velocity at v of such a joint from the axes before a rotation to the axes after it. The last degrees of freedom in `turn` are the
/// rotation vector [rad].
inline void turnAxes(int linear, const double* turn, double* v) {
  const bool planar = linear == 2;
  const Vec3<double> w = planar ? Vec3<double>{0, 0, turn[2]} : Vec3<double>{turn[3], turn[4], turn[5]};
  const Vec3<double> turned = transposeTimes(exp3(w), Vec3<double>{v[0], v[1], planar ? 0 : v[2]});
  for (int k = 0; k < linear; ++k) v[k] = turned[k];
}

/// a += w x v for the linear velocities of free and planar joints: the part of the linear acceleration that is due to the rotation of the axes and
/// not in the rates of the components. v and a are in the user's coordinates.
inline void addTurning(const CompactImpl& m, const double* v, double* a) {
  for (const TypeBatch& batch : m.batches) {
    const int linear = slidingAndTurning(batch.shape);
    if (linear == 0) continue;
    for (const int body : batch.bodies) {
      const int first = m.index[static_cast<std::size_t>(body)].user_v;
      if (first < 0) continue;
      const double* x = v + first;
      const bool planar = linear == 2;
      const Vec3<double> w = planar ? Vec3<double>{0, 0, x[2]} : Vec3<double>{x[3], x[4], x[5]};
      const Vec3<double> turned = cross(w, {x[0], x[1], planar ? 0 : x[2]});
      a[first] += turned.x;
      a[first + 1] += turned.y;
      if (!planar) a[first + 2] += turned.z;
    }
  }
}

}  // namespace dyn
