// SPDX-License-Identifier: BSD-2-Clause
// FCL's library checks itself by assertions that end the process on ordinary input. Therefore this source compiles FCL's search, which FCL has in a
// header, for itself: here a failed assertion is an exception. Like broadphase.cpp, it is compiled for the instruction set of Debian's FCL.
#include "geometry/narrow/fcl.hpp"

#include <Eigen/Geometry>

// All that FCL's search includes is included before it, so that only its own assertions change.
#include <fcl/common/unused.h>
#include <fcl/common/warning.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/ellipsoid.h>
#include <fcl/geometry/shape/halfspace.h>
#include <fcl/geometry/shape/plane.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/alloc.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/list.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/polytope.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/simplex.h>
#include <fcl/narrowphase/detail/failed_at_this_configuration.h>

#include <ccd/ccd.h>
#include <ccd/quat.h>
#include <ccd/vec3.h>

#include <array>
#include <cassert>
#include <limits>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <variant>

namespace {
[[noreturn]] void failedAssertion(const char* what) { throw dyn::FclFailure(std::string("its assertion fails: ") + what); }
}  // namespace

#undef NDEBUG  // declares what FCL's assertions call
#undef assert
#define assert(x) ((x) ? void() : failedAssertion(#x))
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#undef assert

namespace dyn {

#if defined(__x86_64__)
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "FCL's headers must be compiled for the instruction set that its library was built for");
#endif

namespace {

namespace search = fcl::detail::libccd_extension;
using namespace fcl::detail;

/// FCL's limit for one search is 1000 steps, but its EPA has none. A search that takes more support points than this does not converge.
constexpr int most_supports = 4000;

struct Hull : ccd_obj_t {
  const Convex* solid;
};

void supportHull(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const Hull& hull = *static_cast<const Hull*>(object);
  ccd_vec3_t n = *direction;
  ccdQuatRotVec(&n, &hull.rot_inv);
  const Vec3<double> x = hull.solid->support({n.v[0], n.v[1], n.v[2]});
  ccdVec3Set(point, x.x, x.y, x.z);
  ccdQuatRotVec(point, &hull.rot);
  ccdVec3Add(point, &hull.pos);
}

ccd_obj_t poseOf(const SE3<double>& X) {
  const Eigen::Quaterniond q(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.m).eval());
  ccd_obj_t o;
  ccdVec3Set(&o.pos, X.p.x, X.p.y, X.p.z);
  ccdQuatSet(&o.rot, q.x(), q.y(), q.z(), q.w());
  ccdQuatInvert2(&o.rot_inv, &o.rot);
  return o;
}

/// A placed solid with FCL's support function for it.
class Solid {
 public:
  Solid(const Convex& c, const SE3<double>& X) { place(c, X); }
  Solid(const Solid&) = delete;
  Solid& operator=(const Solid&) = delete;

  /// The support function that libccd calls, with a Solid as object. It throws through __ccdSupport, a C function of libccd, which therefore needs
  /// unwind tables: compilers for x86-64 and aarch64 write them by default.
  static void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
    const Solid& s = *static_cast<const Solid*>(object);
    if (++s.supports_ > most_supports) throw FclFailure("the search does not end");
    s.support_(s.address_, direction, point);
  }

 private:
  void place(const Convex& c, const SE3<double>& X) {
    const ccd_obj_t pose = poseOf(X);
    switch (c.core) {
      case Core::point:
        return set(ccd_sphere_t{pose, c.margin}, &supportSphere);
      case Core::segment:
        return set(ccd_cap_t{pose, c.margin, c.half.z}, &supportCap);
      case Core::box:
        return set(ccd_box_t{pose, {c.half.x, c.half.y, c.half.z}}, &supportBox);
      case Core::cylinder:
        return set(ccd_cyl_t{pose, c.half.x, c.half.z}, &supportCyl);
      case Core::cone:
        return set(ccd_cone_t{pose, c.half.x, c.half.z}, &supportCone);
      default:
        return set(Hull{pose, &c}, &supportHull);
    }
  }
  template <class Shape>
  void set(const Shape& shape, ccd_support_fn function) {
    address_ = &shape_.emplace<Shape>(shape);
    support_ = function;
  }

  std::variant<ccd_sphere_t, ccd_cap_t, ccd_box_t, ccd_cyl_t, ccd_cone_t, Hull> shape_;
  const void* address_ = nullptr;
  ccd_support_fn support_ = nullptr;
  mutable int supports_ = 0;
};

/// FCL's polytope is freed also if FCL throws.
struct Polytope : ccd_pt_t {
  Polytope() { ccdPtInit(this); }
  ~Polytope() { ccdPtDestroy(this); }
  Polytope(const Polytope&) = delete;
  Polytope& operator=(const Polytope&) = delete;
};

/// FCL's ccdGJKSignedDist after its GJK. That function returns -1 if it fails; this one throws.
double signedDistance(const Solid& a, const Solid& b, const ccd_t& ccd, ccd_simplex_t& simplex, bool overlap, ccd_vec3_t& on_a, ccd_vec3_t& on_b) {
  if (!overlap) {
    const double distance = search::_ccdDist(&a, &b, &ccd, &simplex, &on_a, &on_b);
    if (distance < 0) throw FclFailure("the search for the distance does not end");
    return distance;
  }
  Polytope polytope;
  ccd_pt_el_t* nearest = nullptr;
  if (search::__ccdEPA(&a, &b, &ccd, &simplex, &polytope, &nearest) != 0 || nearest == nullptr)
    throw FclFailure("the search for the depth finds no polytope around the origin");
  search::penEPAPosClosest(nearest, &on_a, &on_b);
  return -std::sqrt(nearest->dist);
}

Vec3<double> vector(const ccd_vec3_t& x) { return {x.v[0], x.v[1], x.v[2]}; }

}  // namespace

Separation fclSeparation(const Convex& a, const Convex& b, const SE3<double>& aMb, bool touch_only, double tolerance) {
  const Solid first(a, {}), second(b, aMb);
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = &Solid::support;
  ccd.max_iterations = 1000;
  ccd.dist_tolerance = ccd.epa_tolerance = tolerance;
  Separation s;
  ccd_vec3_t on_a{}, on_b{};
  try {
    ccd_simplex_t simplex;
    const bool overlap = search::__ccdGJK(&first, &second, &ccd, &simplex) == 0;
    if (touch_only) {
      s.distance = overlap ? 0 : std::numeric_limits<double>::infinity();
      return s;
    }
    s.distance = signedDistance(first, second, ccd, simplex, overlap, on_a, on_b);
    s.on_a = vector(on_a);
    s.on_b = vector(on_b);
    const Vec3<double> gap = s.on_b - s.on_a;
    const double length = norm(gap);
    s.normal = length > 0 ? ((overlap ? -1 : 1) / length) * gap : separation(a, b, aMb, std::numeric_limits<double>::infinity(), false).normal;
  } catch (const FailedAtThisConfiguration& e) {
    throw FclFailure(e.what());
  }
  return s;
}

}  // namespace dyn
