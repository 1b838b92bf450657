// Whether volumes touch, and where. Two that share a point collide.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/geometry/geometry_data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

/// Of a pair of geometries a and b, in the world.
struct Contact {
  int pair = 0;
  Vec3<double> position;  ///< between the two surfaces' points
  Vec3<double> normal;    ///< unit, from a towards b: b is parted from a by moving it along `normal` by `depth`
  double depth = 0;       ///< [m]
};

// At the placements of the last updateGeometryPlacements. Pairs whose bounding spheres or boxes do not meet cost no more than that.

/// Whether one pair collides. Throws Error(argument) for a number out of range.
DYN_API bool computeCollision(const GeometryModel& geometry, GeometryData& data, int pair);
/// Whether any pair collides; stops at the first, which is firstCollision().
DYN_API bool anyCollision(const GeometryModel& geometry, GeometryData& data);
DYN_API int firstCollision(const GeometryData& data);  ///< -1 if the last anyCollision() found none
/// The pairs that collide, in the order of pairs().
DYN_API const std::vector<int>& computeCollisions(const GeometryModel& geometry, GeometryData& data);
/// Contacts of all pairs that collide, in the order of pairs(); of meshes and voxels one for each two pieces that meet. No more than
/// the data has room for.
DYN_API const std::vector<Contact>& computeContacts(const GeometryModel& geometry, GeometryData& data);

struct GeometryBatchImpl;

/// Holds what computeCollisions of many states needs: for each thread a Data and a GeometryData. In a child of fork() the first call starts its
/// threads anew.
class DYN_API GeometryBatch {
 public:
  /// Throws Error(argument) unless capacity and threads are positive.
  GeometryBatch(const CompactModel& model, const GeometryModel& geometry, int capacity, int threads = 1);
  ~GeometryBatch();
  GeometryBatch(GeometryBatch&&) noexcept;
  GeometryBatch& operator=(GeometryBatch&&) noexcept;

  int capacity() const;
  GeometryBatchImpl& impl() { return *impl_; }

 private:
  Owned<GeometryBatchImpl> impl_;
};

namespace detail {
DYN_API const unsigned char* batchCollisions(const CompactModel&, GeometryBatch&, StatesView<double> q);
}  // namespace detail

/// For each column of Q, nq x N with N at most the capacity, 1 if any pair collides at it and 0 if none. The same whatever the number of
/// threads. Throws Error(size); Error(argument) naming the state for a quaternion that is zero or a number that is not finite.
inline auto computeCollisions(const CompactModel& model, GeometryBatch& batch, const detail::States<double>& Q) {
  const detail::StatesView<double> view = Q;
  return Eigen::Map<const Eigen::Matrix<unsigned char, Eigen::Dynamic, 1>>(detail::batchCollisions(model, batch, view), view.cols);
}

}  // namespace dyn
