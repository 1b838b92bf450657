// SPDX-License-Identifier: BSD-2-Clause
// Collision checks: whether volumes touch, and where. Two volumes that share a point collide.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/geometry/geometry_data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

/// A contact of a pair of geometries a and b, in world coordinates.
struct Contact {
  int pair = 0;           ///< its index in pairs()
  Vec3<double> position;  ///< [m] midpoint between the contact points of the two surfaces
  Vec3<double> normal;    ///< unit, from a towards b; moving b along it by `depth` separates b from a
  double depth = 0;       ///< [m] by which they overlap
};

/// Returns whether one pair collides. Throws Error(argument) for a number out of range.
///
/// This and the functions below use the placements of the last updateGeometryPlacements. A pair whose bounding spheres or boxes do not meet costs
/// only that test. All throw Error(argument) if the data belongs to another geometry.
DYN_API bool computeCollision(const GeometryModel& geometry, GeometryData& data, int pair);
/// Returns whether any pair collides. Stops at the first one found, which firstCollision() then returns.
DYN_API bool anyCollision(const GeometryModel& geometry, GeometryData& data);
/// Returns the index of the pair that the last anyCollision() found; -1 if it found none.
DYN_API int firstCollision(const GeometryData& data);
/// Returns the indices of the pairs that collide, in the order of pairs(). The data owns the vector; the next call overwrites it.
DYN_API const std::vector<int>& computeCollisions(const GeometryModel& geometry, GeometryData& data);
/// Returns contacts of all pairs that collide, in the order of pairs(). Meshes and voxels give one contact for each two pieces (triangles, cubes)
/// that meet. Contacts for which the data has no room are left out. The data owns the vector; the next call overwrites it.
DYN_API const std::vector<Contact>& computeContacts(const GeometryModel& geometry, GeometryData& data);

struct GeometryBatchImpl;

/// Memory for computeCollisions of many states: a Data and a GeometryData for each thread. After fork(), the first call in the child starts new
/// threads.
class DYN_API GeometryBatch {
 public:
  /// Takes memory for at most `capacity` states, and starts the threads. Throws Error(argument) unless both numbers are positive, and if
  /// the system gives fewer threads.
  GeometryBatch(const CompactModel& model, const GeometryModel& geometry, int capacity, int threads = 1);
  ~GeometryBatch();
  GeometryBatch(GeometryBatch&&) noexcept;
  GeometryBatch& operator=(GeometryBatch&&) noexcept;

  /// Returns the largest number of states of one call.
  int capacity() const;
  GeometryBatchImpl& impl() { return *impl_; }  ///< implementation, internal to libdyn

 private:
  Owned<GeometryBatchImpl> impl_;
};

namespace detail {
DYN_API const unsigned char* batchCollisions(const CompactModel&, GeometryBatch&, StatesView<double> q);
}  // namespace detail

/// Checks each column of Q, which is nq x N with N at most the capacity. Returns N flags: 1 if any pair collides, else 0. The result does not depend
/// on the number of threads. Throws Error(size), and Error(argument), naming the state, for a zero quaternion or a number that is not finite.
inline auto computeCollisions(const CompactModel& model, GeometryBatch& batch, const detail::States<double>& Q) {
  const detail::StatesView<double> view = Q;
  return Eigen::Map<const Eigen::Matrix<unsigned char, Eigen::Dynamic, 1>>(detail::batchCollisions(model, batch, view), view.cols);
}

}  // namespace dyn
