#include "geometry/queries.hpp"

#include <algorithm>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// What a tree's answer needs to become a pair.
struct Finder {
  const GeometryImpl& m;
  std::vector<int>& pairs;
  int geometry;
};

bool collidesBySpheres(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  if (sphereBound(m, d, pair) > 0) return false;
  const PlacedPair p = placed(m, d, pair);
  return collide(p.a, p.b, p.aMb);
}

}  // namespace

const std::vector<int>& nearPairs(const GeometryImpl& m, GeometryDataImpl& d) {
  d.near_pairs.clear();
  Finder finder{m, d.near_pairs, 0};
  const auto add = [](void* context, int other) {
    Finder& f = *static_cast<Finder*>(context);
    if (const int pair = f.m.pairOf(f.geometry, other); pair >= 0) f.pairs.push_back(pair);
    return true;
  };
  if (m.still) {
    for (const int g : m.moving) {
      finder.geometry = g;
      if (m.volumes[at(g)]->bounded() && !m.volumes[at(g)]->empty()) m.still->meeting(d.bounds[at(g)], add, &finder);
    }
  }
  if (d.moving) {
    d.moving->pairs(
        [](void* context, int a, int b) {
          Finder& f = *static_cast<Finder*>(context);
          const int pair = f.m.pairOf(a, b);
          if (pair >= 0 && f.m.records[at(a)].joint != 0 && f.m.records[at(b)].joint != 0) f.pairs.push_back(pair);
          return true;
        },
        &finder);
  }
  for (const int pair : m.listed) {
    const auto [a, b] = m.pairs[at(pair)];
    if (!m.volumes[at(a)]->bounded() || !m.volumes[at(b)]->bounded() || d.bounds[at(a)].meets(d.bounds[at(b)])) d.near_pairs.push_back(pair);
  }
  std::sort(d.near_pairs.begin(), d.near_pairs.end());
  return d.near_pairs;
}

bool computeCollision(const GeometryModel& geometry, GeometryData& data, int pair) {
  checkPair(geometry.impl(), pair);
  return collidesBySpheres(geometry.impl(), data.impl(), pair);
}

bool anyCollision(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = data.impl();
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
  GeometryDataImpl& d = data.impl();
  d.colliding.clear();
  for (const int pair : nearPairs(geometry.impl(), d))
    if (collidesBySpheres(geometry.impl(), d, pair)) d.colliding.push_back(pair);
  return d.colliding;
}

const std::vector<Contact>& computeContacts(const GeometryModel& geometry, GeometryData& data) {
  GeometryDataImpl& d = data.impl();
  d.contacts.clear();
  struct Collector {
    std::vector<Contact>& contacts;
    const SE3<double>* oMa;
    int pair;
  } collector{d.contacts, nullptr, 0};
  for (const int pair : nearPairs(geometry.impl(), d)) {
    if (sphereBound(geometry.impl(), d, pair) > 0) continue;
    const PlacedPair p = placed(geometry.impl(), d, pair);
    collector.oMa = &p.oMa;
    collector.pair = pair;
    contacts(
        p.a, p.b, p.aMb,
        [](void* context, const Separation& s) {
          Collector& c = *static_cast<Collector*>(context);
          if (c.contacts.size() == c.contacts.capacity()) return false;
          c.contacts.push_back({c.pair, c.oMa->act(0.5 * (s.on_a + s.on_b)), c.oMa->R * s.normal, -s.distance});
          return true;
        },
        &collector);
  }
  return d.contacts;
}

}  // namespace dyn
