// How far volumes are from one another, and how that changes with q.
#pragma once

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/geometry/geometry_data.hpp>

namespace dyn {

/// Of a pair of geometries a and b, in the world: nearest_b - nearest_a = distance * normal.
struct Distance {
  int pair = -1;
  double distance = 0;  ///< [m]; negative: b must be moved by so much along the normal until the two only touch
  Vec3<double> normal;  ///< unit, from a towards b
  Vec3<double> nearest_a, nearest_b;
};

// At the placements of the last updateGeometryPlacements. Of meshes and voxels that overlap the distance is that of the two pieces, triangles
// or cubes, that overlap deepest. Two half-spaces that are not parallel overlap by infinity.

/// Throws Error(argument) for a number out of range.
DYN_API Distance computeDistance(const GeometryModel& geometry, GeometryData& data, int pair);
/// Of all pairs, in their order.
DYN_API const std::vector<Distance>& computeDistances(const GeometryModel& geometry, GeometryData& data);
/// The least of all pairs, the first of several; pair = -1 and infinity where there are none. Most pairs are ruled out by bounding spheres.
DYN_API Distance computeMinimumDistance(const GeometryModel& geometry, GeometryData& data);

/// d(distance)/dq along the tangent, nv numbers: normal . (J_b - J_a), with the Jacobians of the two nearest points as the bodies carry them.
/// The distance's own derivative wherever the nearest points are unique; one of its subgradients elsewhere. `data` holds the q that the
/// placements are of. O(depth) beside two nv-vectors. Throws Error(size), Error(argument).
DYN_API void computeDistanceDerivative(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data,
                                       const Distance& distance, const VectorOut& derivative);

}  // namespace dyn
