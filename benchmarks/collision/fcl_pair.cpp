// SPDX-License-Identifier: BSD-2-Clause
#include "fcl_pair.hpp"

#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/cone.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

#include <stdexcept>

namespace dyn::bench {

namespace {

std::shared_ptr<fcl::CollisionGeometryd> shapeOf(const GeometryShape& shape) {
  if (const auto* s = std::get_if<geometry::Sphere>(&shape)) return std::make_shared<fcl::Sphered>(s->radius);
  if (const auto* s = std::get_if<geometry::Box>(&shape)) return std::make_shared<fcl::Boxd>(s->size.x, s->size.y, s->size.z);
  if (const auto* s = std::get_if<geometry::Capsule>(&shape)) return std::make_shared<fcl::Capsuled>(s->radius, s->length);
  if (const auto* s = std::get_if<geometry::Cylinder>(&shape)) return std::make_shared<fcl::Cylinderd>(s->radius, s->length);
  if (const auto* s = std::get_if<geometry::Cone>(&shape)) return std::make_shared<fcl::Coned>(s->radius, s->length);
  throw std::invalid_argument("not measured");
}

fcl::Transform3d transformOf(const SE3<double>& X) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) t.linear()(i, j) = X.R(i, j);
  t.translation() = fcl::Vector3d(X.p.x, X.p.y, X.p.z);
  return t;
}

}  // namespace

struct FclPair::Impl {
  std::shared_ptr<fcl::CollisionGeometryd> a, b;
};

FclPair::FclPair(const GeometryShape& a, const GeometryShape& b) : impl_(new Impl{shapeOf(a), shapeOf(b)}) {}
FclPair::FclPair(FclPair&&) noexcept = default;
FclPair::~FclPair() = default;

double FclPair::distance(const SE3<double>& a, const SE3<double>& b, Vec3<double>& normal) const {
  const fcl::DistanceRequestd request(true, true);
  fcl::DistanceResultd result;
  fcl::distance(impl_->a.get(), transformOf(a), impl_->b.get(), transformOf(b), request, result);
  const fcl::Vector3d n = (result.nearest_points[1] - result.nearest_points[0]) / result.min_distance;
  normal = {n.x(), n.y(), n.z()};
  return result.min_distance;
}

}  // namespace dyn::bench
