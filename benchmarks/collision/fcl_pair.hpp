// FCL's own distance of two solids, to be measured beside libdyn's. FCL is known to one source only: see libdyn/src/geometry/broadphase.cpp.
#pragma once

#include <dyn/model/geometry_description.hpp>

#include <memory>

namespace dyn::bench {

class FclPair {
 public:
  FclPair(const GeometryShape& a, const GeometryShape& b);
  FclPair(FclPair&&) noexcept;
  ~FclPair();
  /// Signed distance with nearest points; `normal` from a towards b.
  double distance(const SE3<double>& a, const SE3<double>& b, Vec3<double>& normal) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace dyn::bench
