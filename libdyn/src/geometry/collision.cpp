// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "geometry/queries.hpp"

#include <algorithm>

namespace dyn {

namespace {

bool collidesBySpheres(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  if (sphereBound(m, d, pair) > 0) return false;
  return placed(m, d, pair).collide();
}

}  // namespace

const std::vector<int>& nearPairs(const GeometryImpl& m, GeometryDataImpl& d) {
  d.near_pairs = m.unbounded;
  const auto add = [&](int a, int b) {
    if (const int pair = m.pairOf(a, b); pair >= 0) d.near_pairs.push_back(pair);
  };
  for (const int g : m.moving) {
    if (!m.volumes[at(g)]->bounded() || m.volumes[at(g)]->empty()) continue;
    const auto found = [&](int other) { add(g, other); };
    if (m.still_tree) {
      m.still_tree->meeting(d.bounds[at(g)], found);
    } else {
      m.still_boxes.meeting(d.bounds[at(g)], found);
    }
  }
  if (d.moving) d.moving->pairs(add);
  for (const int pair : m.listed) {
    const auto [a, b] = m.pairs[at(pair)];
    if (d.bounds[at(a)].meets(d.bounds[at(b)])) d.near_pairs.push_back(pair);
  }
  std::sort(d.near_pairs.begin(), d.near_pairs.end());
  return d.near_pairs;
}

bool computeCollision(const GeometryModel& geometry, GeometryData& data, int pair) {
  checkPair(geometry.impl(), pair);
  return collidesBySpheres(geometry.impl(), dataOf("computeCollision", geometry, data), pair);
}

bool anyCollision(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = dataOf("anyCollision", geometry, data);
  d.first = -1;
  for (const int pair : nearPairs(geometry.impl(), d)) {
    if (!collidesBySpheres(geometry.impl(), d, pair)) continue;
    d.first = pair;
    return true;
  }
  return false;
}

int firstCollision(const GeometryData& data) { return data.impl().first; }

const std::vector<int>& computeCollisions(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = dataOf("computeCollisions", geometry, data);
  d.colliding.clear();
  for (const int pair : nearPairs(geometry.impl(), d))
    if (collidesBySpheres(geometry.impl(), d, pair)) d.colliding.push_back(pair);
  return d.colliding;
}

const std::vector<Contact>& computeContacts(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = dataOf("computeContacts", geometry, data);
  d.contacts.clear();
  for (const int pair : nearPairs(geometry.impl(), d)) {
    if (sphereBound(geometry.impl(), d, pair) > 0) continue;
    const PlacedPair p = placed(geometry.impl(), d, pair);
    p.contacts(0, [&](const NearPieces& x) {
      const Separation& s = x.s;
      if (d.contacts.size() == d.contacts.capacity()) return false;
      d.contacts.push_back({pair, p.oMa.act(0.5 * (s.on_a + s.on_b)), p.oMa.R * s.normal, -s.distance});
      return true;
    });
  }
  return d.contacts;
}

}  // namespace dyn
