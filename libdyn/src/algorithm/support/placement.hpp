// SPDX-License-Identifier: BSD-2-Clause
// Placements of joints and frames on bodies, and motions in the reference frame that the user wants.
#pragma once

#include "data/data_impl.hpp"
#include "kernels/recursion/kinematics.hpp"

#include <dyn/algorithm/kinematics.hpp>
#include <dyn/error.hpp>

#include <string>

namespace dyn {

struct PointOnBody {
  int body;
  const SE3<double>& placement;  ///< in the body's core frame
};

/// The placement of a frame or joint. Throw Error(argument) for a number out of range.
PointOnBody frameOnBody(const CompactModel& model, int frame);
PointOnBody jointOnBody(const CompactModel& model, int joint);

/// The classical acceleration of a frame's origin and the angular acceleration, in the frame's axes. The frame is fixed to a body. O(depth).
inline Motion<double> originAccelerationOf(const CompactImpl& m, const PointOnBody& x, const DataImpl& d) {
  Vec3<double> sum;  // world axes
  for (int i = x.body; i > 0; i = m.index[static_cast<std::size_t>(i)].parent) {
    const int p = m.index[static_cast<std::size_t>(i)].parent;
    sum += d.oM[p].R * kernels::beyondOrigin(d.a[p].angular, d.v[p].angular, d.rel[i].p) + d.oM[i].R * d.sliding[i];
  }
  const Vec3<double>& angular = d.a[x.body].angular;
  const Vec3<double> there = transposeTimes(d.oM[x.body].R, sum) + kernels::beyondOrigin(angular, d.v[x.body].angular, x.placement.p);
  return {transposeTimes(x.placement.R, there), transposeTimes(x.placement.R, angular)};
}

/// Throws Error(argument) if the value is none of the three.
inline void checkReference(ReferenceFrame reference) {
  if (reference != ReferenceFrame::LOCAL && reference != ReferenceFrame::WORLD && reference != ReferenceFrame::LOCAL_WORLD_ALIGNED)
    throw Error(ErrorCode::argument,
                "ReferenceFrame(" + std::to_string(static_cast<int>(reference)) + ") does not exist; it is LOCAL, WORLD or LOCAL_WORLD_ALIGNED");
}

/// Expresses a motion in the reference. `local` is in the frame's axes, at its origin.
template <class T>
Motion<T> express(const Motion<T>& local, const SE3<T>& oMf, ReferenceFrame reference) {
  switch (reference) {
    case ReferenceFrame::LOCAL:
      return local;
    case ReferenceFrame::WORLD:
      return oMf.act(local);
    case ReferenceFrame::LOCAL_WORLD_ALIGNED:
      return {oMf.R * local.linear, oMf.R * local.angular};
  }
  checkReference(reference);
  return local;
}

}  // namespace dyn
