// Where geometries are, and what was found about them: scratch and results for one thread.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/geometry/geometry_model.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct GeometryDataImpl;

/// All memory is taken when it is made, but that of the broadphase, which FCL takes when a scene has many moving bodies.
class DYN_API GeometryData {
 public:
  /// `contacts`: how many one call can report.
  explicit GeometryData(const GeometryModel& model, int contacts = 256);
  ~GeometryData();
  GeometryData(GeometryData&&) noexcept;
  GeometryData& operator=(GeometryData&&) noexcept;
  GeometryData(const GeometryData&) = delete;
  GeometryData& operator=(const GeometryData&) = delete;

  GeometryDataImpl& impl() { return *impl_; }
  const GeometryDataImpl& impl() const { return *impl_; }

 private:
  Owned<GeometryDataImpl> impl_;
};

/// Places all geometries by the joints' poses that the last forwardKinematics found. O(number of geometries that move).
/// Throws Error(argument) if the geometry was compiled for another model, `data` is of another, or the two geometries do not belong together.
/// Volumes meet by their places in the world: a base 10^9 m away leaves them 1e-7 m.
DYN_API void updateGeometryPlacements(const CompactModel& model, const Data& data, const GeometryModel& geometry, GeometryData& geometry_data);
/// The same at q, with its forwardKinematics.
DYN_API void updateGeometryPlacements(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data,
                                      const VectorArg& q);

/// Pose of a geometry in the world. Throws Error(argument) for a number out of range, or data of another geometry.
DYN_API SE3<double> geometryPlacement(const GeometryModel& geometry, const GeometryData& geometry_data, int id);

}  // namespace dyn
