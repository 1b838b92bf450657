// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "geometry/queries.hpp"

#include <algorithm>
#include <limits>

namespace dyn {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Distance distanceOf(const GeometryImpl& m, const GeometryDataImpl& d, int pair, double beyond) {
  const PlacedPair p = placed(m, d, pair);
  const Separation s = p.nearest(beyond);
  return {pair, s.distance, p.oMa.R * s.normal, p.oMa.act(s.on_a), p.oMa.act(s.on_b)};
}

/// Adds normal . J to `row`, with J the Jacobian (3 x nv) of the body's point at x.
void addVelocity(const CompactModel& model, Data& data, int joint, const Vec3<double>& x, const Vec3<double>& normal, std::vector<double>& jacobian,
                 double* row) {
  if (joint == 0) return;
  const int nv = model.nv();
  getJointJacobian(model, data, joint, ReferenceFrame::LOCAL_WORLD_ALIGNED, MatrixOut(jacobian.data(), 6, nv));
  const Vec3<double> moment = cross(x - jointPlacement(model, data, joint).p, normal);
  for (int k = 0; k < nv; ++k) {
    const double* column = jacobian.data() + 6 * k;
    row[k] += normal.x * column[0] + normal.y * column[1] + normal.z * column[2] + moment.x * column[3] + moment.y * column[4] + moment.z * column[5];
  }
}

}  // namespace

Distance computeDistance(const GeometryModel& geometry, GeometryData& data, int pair) {
  checkPair(geometry.impl(), pair);
  return distanceOf(geometry.impl(), dataOf("computeDistance", geometry, data), pair, infinity);
}

const std::vector<Distance>& computeDistances(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = dataOf("computeDistances", geometry, data);
  d.distances.clear();
  for (std::size_t p = 0; p < geometry.impl().pairs.size(); ++p) d.distances.push_back(distanceOf(geometry.impl(), d, static_cast<int>(p), infinity));
  return d.distances;
}

Distance computeMinimumDistance(const GeometryModel& geometry, GeometryData& data) {
  const GeometryImpl& m = geometry.impl();
  const GeometryDataImpl& d = dataOf("computeMinimumDistance", geometry, data);
  Distance best;
  best.distance = infinity;
  const int n = static_cast<int>(m.pairs.size());
  // The pair with the nearest bounding spheres comes first: its distance rules out most other pairs.
  int start = -1;
  double nearest_bound = infinity;
  for (int p = 0; p < n; ++p) {
    const double bound = sphereBound(m, d, p);
    if (bound < nearest_bound) nearest_bound = bound, start = p;
  }
  if (start < 0) return best;
  best = distanceOf(m, d, start, infinity);
  for (int p = 0; p < n; ++p) {
    // Overlapping spheres do not bound the depth of an overlap, so such pairs are never ruled out.
    if (p == start || sphereBound(m, d, p) > std::max(best.distance, 0.0)) continue;
    const Distance x = distanceOf(m, d, p, std::max(best.distance, 0.0));
    if (x.distance < best.distance || (x.distance == best.distance && p < best.pair)) best = x;
  }
  return best;
}

void computeDistanceDerivative(const CompactModel& model, Data& data, const GeometryModel& geometry, GeometryData& geometry_data,
                               const Distance& distance, const VectorOut& derivative) {
  const GeometryImpl& m = geometry.impl();
  checkModel("computeDistanceDerivative", model, geometry);
  checkPair(m, distance.pair);
  if (derivative.size() != m.nv)
    throw Error(ErrorCode::size, "computeDistanceDerivative: the derivative has " + std::to_string(derivative.size()) +
                                     " numbers; it needs nv = " + std::to_string(m.nv));
  std::fill_n(derivative.data(), m.nv, 0.0);
  std::vector<double>& jacobian = dataOf("computeDistanceDerivative", geometry, geometry_data).jacobian;
  const auto [a, b] = m.pairs[at(distance.pair)];
  addVelocity(model, data, m.records[at(b)].joint, distance.nearest_b, distance.normal, jacobian, derivative.data());
  addVelocity(model, data, m.records[at(a)].joint, distance.nearest_a, -distance.normal, jacobian, derivative.data());
}

}  // namespace dyn
