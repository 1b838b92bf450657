// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "geometry/queries.hpp"

#include <dyn/algorithm/kinematics.hpp>

namespace dyn {

GeometryDataImpl::GeometryDataImpl(const GeometryModel& geometry, int most_contacts) : model(geometry) {
  const GeometryImpl& m = geometry.impl();
  const std::size_t n = m.records.size();
  placement.resize(n);
  center.resize(n);
  bounds.resize(n);
  if (m.tree_of_moving) moving = std::make_unique<Broadphase>(static_cast<int>(n));
  near_pairs.reserve(m.pairs.size());
  colliding.reserve(m.pairs.size());
  contacts.reserve(at(most_contacts));
  distances.reserve(m.pairs.size());
  jacobian.resize(6 * at(m.nv));
  // These placements are final for static geometries, whose joint is the world. Moving geometries get provisional ones.
  for (std::size_t g = 0; g < n; ++g) place(static_cast<int>(g), m.records[g].placement);
}

void GeometryDataImpl::place(int geometry, const SE3<double>& oMg) {
  const Volume& volume = *model.impl().volumes[at(geometry)];
  placement[at(geometry)] = oMg;
  if (volume.empty() || !volume.bounded()) return;
  center[at(geometry)] = oMg.act(volume.bounds().center());
  bounds[at(geometry)] = moved(volume.bounds(), oMg);
  if (margin > 0) bounds[at(geometry)].grow(margin);
  if (moving && model.impl().moves(geometry)) moving->place(geometry, bounds[at(geometry)]);
}

namespace {
int checked(int contacts) {
  if (contacts < 0) throw Error(ErrorCode::argument, "GeometryData: " + std::to_string(contacts) + " contacts; it takes none or more");
  return contacts;
}
}  // namespace

GeometryData::GeometryData(const GeometryModel& model, int contacts) : impl_(std::make_unique<GeometryDataImpl>(model, checked(contacts))) {}
GeometryData::~GeometryData() = default;
GeometryData::GeometryData(GeometryData&&) noexcept = default;
GeometryData& GeometryData::operator=(GeometryData&&) noexcept = default;

void updateGeometryPlacements(const CompactModel& model, const Data& data, const GeometryModel& geometry, GeometryData& geometry_data) {
  const GeometryImpl& m = geometry.impl();
  checkModel("updateGeometryPlacements", model, geometry);
  GeometryDataImpl& d = dataOf("updateGeometryPlacements", geometry, geometry_data);
  // Consecutive geometries often belong to one joint, whose pose is then read once.
  int joint = -1;
  SE3<double> oMj;
  for (const int g : m.moving) {
    const GeometryRecord& r = m.records[at(g)];
    if (r.joint != joint) oMj = jointPlacement(model, data, joint = r.joint);
    d.place(g, oMj * r.placement);
  }
  if (d.moving) d.moving->update();
}

void updateGeometryPlacements(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data, const VectorArg& q) {
  forwardKinematics(model, data, q);
  updateGeometryPlacements(model, data, geometry, geometry_data);
}

SE3<double> geometryPlacement(const GeometryModel& geometry, const GeometryData& geometry_data, int id) {
  const std::size_t n = geometry.impl().records.size();
  if (id < 0 || at(id) >= n) throw Error(ErrorCode::argument, "geometry " + std::to_string(id) + " does not exist; there are " + std::to_string(n));
  return dataOf("geometryPlacement", geometry, geometry_data).placement[at(id)];
}

}  // namespace dyn
