// SPDX-License-Identifier: BSD-2-Clause
// FCL's signed distance of two solids (GJK and EPA on libccd), for users who choose it. The header hides FCL's types, as broadphase.hpp does.
#pragma once

#include "geometry/narrow/convex.hpp"

#include <stdexcept>

namespace dyn {

/// FCL found no answer. The text is FCL's own.
struct FclFailure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// As separation(), but by FCL, with the error that its tolerance [m] leaves. The solids overlap if FCL's GJK says so. Nearest points that coincide
/// give no direction; then the normal is that of separation(). Allocates where solids overlap. Throws FclFailure. Not for half-spaces.
Separation fclSeparation(const Convex& a, const Convex& b, const SE3<double>& aMb, bool touch_only, double tolerance);

}  // namespace dyn
