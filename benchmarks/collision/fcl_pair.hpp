// SPDX-License-Identifier: BSD-2-Clause
// FCL's own distance between two solids, timed for comparison with libdyn's. Only fcl_pair.cpp includes FCL, for the reason that
// libdyn/src/geometry/broadphase.cpp gives.
#pragma once

#include <dyn/model/geometry_description.hpp>

#include <memory>

namespace dyn::bench {

class FclPair {
 public:
  FclPair(const GeometryShape& a, const GeometryShape& b);
  FclPair(FclPair&&) noexcept;
  ~FclPair();
  /// Returns the signed distance, computed with nearest points. `normal` points from a towards b.
  double distance(const SE3<double>& a, const SE3<double>& b, Vec3<double>& normal) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn::bench
