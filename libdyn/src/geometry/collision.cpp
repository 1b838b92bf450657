#include "geometry/queries.hpp"

#include <algorithm>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

bool collidesBySpheres(const GeometryImpl& m, const GeometryDataImpl& d, int pair) {
  if (sphereBound(m, d, pair) > 0) return false;
  const PlacedPair p = placed(m, d, pair);
  return collide(p.a, p.b, p.aMb);
}

}  // namespace

const std::vector<int>& nearPairs(const GeometryImpl& m, GeometryDataImpl& d) {
  d.near_pairs = m.unbounded;
  struct Finder {
    const GeometryImpl& m;
    std::vector<int>& pairs;
    int moving;
    void add(int other) {
      if (const int pair = m.pairOf(moving, other); pair >= 0) pairs.push_back(pair);
    }
  } finder{m, d.near_pairs, 0};
  for (const int g : m.moving) {
    if (!m.volumes[at(g)]->bounded() || m.volumes[at(g)]->empty()) continue;
    finder.moving = g;
    if (m.still_tree) {
      const auto found = [](void* context, int other) {
        static_cast<Finder*>(context)->add(other);
        return true;
      };
      m.still_tree->meeting(d.bounds[at(g)], found, &finder);
    } else {
      m.still_boxes.meeting(d.bounds[at(g)], [&](int other) { finder.add(other); });
    }
  }
  if (d.moving) {
    const auto found = [](void* context, int a, int b) {
      Finder& f = *static_cast<Finder*>(context);
      f.moving = a;
      f.add(b);
      return true;
    };
    d.moving->pairs(found, &finder);
  }
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
