// SPDX-License-Identifier: BSD-2-Clause
// Small scenes with one solid in the world and one on a free body.
#pragma once

#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>

#include <Eigen/Geometry>

namespace dyn::test {

inline JointDescription jointOf(const std::string& name, const std::string& type, const SE3<double>& placement = {}) {
  JointDescription j;
  j.name = name;
  j.type = type;
  j.placement = placement;
  return j;
}

inline double length(const Vec3<double>& x) { return std::sqrt(dot(x, x)); }

inline Eigen::VectorXd configurationOf(const SE3<double>& pose) {
  Eigen::Matrix3d R;
  for (int i = 0; i < 9; ++i) R(i / 3, i % 3) = pose.R.m[i];
  Eigen::VectorXd q(7);
  q << pose.p.x, pose.p.y, pose.p.z, Eigen::Quaterniond(R).normalized().coeffs();
  return q;
}

/// A solid whose sides are at most `size`.
inline GeometryShape someShape(Random& random, double size) {
  const auto side = [&] { return size * random.uniform(0.3, 1); };
  switch (random.below(6)) {
    case 0:
      return geometry::Sphere{side() / 2};
    case 1:
      return geometry::Box{{side(), side(), side()}};
    case 2:
      return geometry::Capsule{side() / 3, side()};
    case 3:
      return geometry::Cylinder{side() / 2, side()};
    case 4:
      return geometry::Cone{side() / 2, side()};
    default: {
      geometry::ConvexHull hull;
      for (int i = 0; i < 12; ++i) hull.points.push_back(side() * random.vector(0.5));
      return hull;
    }
  }
}

/// Solid `a` is fixed in the world at a given pose; solid `b` is on a free body.
struct TwoSolids {
  Model description;
  CompactModel model;
  GeometryModel geometry;
  Data data;
  GeometryData geometry_data;

  static Model describe(const GeometryShape& a, const SE3<double>& at, const GeometryShape& b) {
    Model m;
    m.addBody("body", 0, jointOf("joint", "free_flyer"), {1, {}, {1, 0, 0, 1, 0, 1}});
    m.addGeometry("a", 0, at, a);
    m.addGeometry("b", 1, {}, b);
    return m;
  }
  TwoSolids(const GeometryShape& a, const SE3<double>& at, const GeometryShape& b)
      : description(describe(a, at, b)),
        model(compile(description, registry())),
        geometry(compileGeometry(model, description)),
        data(model),
        geometry_data(geometry) {}

  void move(const SE3<double>& pose) { updateGeometryPlacements(model, data, geometry, geometry_data, configurationOf(pose)); }
  Distance distance(const SE3<double>& pose) {
    move(pose);
    return computeDistance(geometry, geometry_data, 0);
  }
};

}  // namespace dyn::test
