// SPDX-License-Identifier: BSD-2-Clause
// Distances between volumes, and their derivatives with respect to q.
#pragma once

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/geometry/geometry_data.hpp>

namespace dyn {

/// The distance of a pair of geometries a and b, in world coordinates: nearest_b - nearest_a = distance * normal.
struct Distance {
  int pair = -1;           ///< its index in pairs(); -1: there is no pair
  double distance = 0;     ///< [m]; if negative, the two overlap, and moving b by -distance along the normal makes them just touch
  Vec3<double> normal;     ///< unit, from a towards b
  Vec3<double> nearest_a,  ///< [m] nearest point on a's surface
      nearest_b;           ///< [m] nearest point on b's surface
};

/// Returns the distance of one pair. Throws Error(argument) for a number out of range.
///
/// This and the functions below use the placements of the last updateGeometryPlacements, and throw Error(argument) for data of another geometry.
/// Overlapping meshes and voxels have the distance of the two pieces (triangles, cubes) that overlap deepest. Two half-spaces have distance -infinity
/// unless they are parallel and face each other.
DYN_API Distance computeDistance(const GeometryModel& geometry, GeometryData& data, int pair);
/// Returns the distances of all pairs, in the order of pairs(). The data owns the vector; the next call overwrites it.
DYN_API const std::vector<Distance>& computeDistances(const GeometryModel& geometry, GeometryData& data);
/// Returns the smallest distance of all pairs, the first of several. Without pairs it has pair = -1 and distance = infinity. Bounding spheres rule
/// out most pairs.
DYN_API Distance computeMinimumDistance(const GeometryModel& geometry, GeometryData& data);

/// Writes d(distance)/dq along the tangent, nv numbers: normal . (J_b - J_a), with the Jacobians of the two nearest points, each fixed to its body.
/// This is the derivative of the distance where the nearest points are unique, and one of its subgradients elsewhere. `data` must hold the q of the
/// placements. O(depth), beside passes over vectors of nv numbers. Throws Error(size | argument).
DYN_API void computeDistanceDerivative(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data,
                                       const Distance& distance, const VectorOut& derivative);

}  // namespace dyn
