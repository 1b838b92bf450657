// SPDX-License-Identifier: BSD-2-Clause
// Placements of geometries and results of collision checks.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/geometry/geometry_model.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct GeometryDataImpl;

/// Placements, scratch and results, for one thread. The constructor takes all memory, except that of FCL: of its broadphase, which scenes with many
/// moving bodies use, and of its comparison of overlapping volumes (GeometryOptions::Narrow::fcl).
class DYN_API GeometryData {
 public:
  /// One call reports at most `contacts` contacts. Throws Error(argument) if this is negative.
  explicit GeometryData(const GeometryModel& model, int contacts = 256);
  ~GeometryData();
  GeometryData(GeometryData&&) noexcept;
  GeometryData& operator=(GeometryData&&) noexcept;
  GeometryData(const GeometryData&) = delete;
  GeometryData& operator=(const GeometryData&) = delete;

  /// Returns the implementation, which is internal to libdyn.
  /// @{
  GeometryDataImpl& impl() { return *impl_; }
  const GeometryDataImpl& impl() const { return *impl_; }
  /// @}

 private:
  Owned<GeometryDataImpl> impl_;
};

/// Places all geometries according to the joint poses of the last forwardKinematics. O(number of geometries that move).
/// Throws Error(argument) if the geometry or `data` belongs to another model, or `geometry_data` to another geometry.
/// Placements are in the world, so their resolution falls with the distance from its origin: it is 1e-7 m at 10^9 m.
DYN_API void updateGeometryPlacements(const CompactModel& model, const Data& data, const GeometryModel& geometry, GeometryData& geometry_data);
/// Runs forwardKinematics at q first, then does the same.
DYN_API void updateGeometryPlacements(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data,
                                      const VectorArg& q);

/// Returns the pose of a geometry in the world. Throws Error(argument) for a number out of range, or data of another geometry.
DYN_API SE3<double> geometryPlacement(const GeometryModel& geometry, const GeometryData& geometry_data, int id);

}  // namespace dyn
