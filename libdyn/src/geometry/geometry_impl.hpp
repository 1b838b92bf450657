// What GeometryModel and GeometryData hold.
#pragma once

#include "geometry/broadphase.hpp"
#include "geometry/volume.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>

#include <algorithm>
#include <memory>
#include <unordered_map>
#include <vector>

namespace dyn {

struct GeometryImpl {
  std::shared_ptr<const CompactModel> model;  ///< whose joints the records name
  std::vector<GeometryRecord> records;
  std::vector<std::shared_ptr<const Volume>> volumes;  ///< by geometry; those of one file and scale are one
  std::unordered_map<std::string, int> index;          ///< by name
  std::vector<CollisionPair> pairs;                    ///< ascending
  std::vector<int> pairs_of;                           ///< pairs whose first is a: from pairs_of[a] up to pairs_of[a + 1]
  int nv = 0;

  std::vector<int> moving;  ///< geometries that move in the description, ascending
  /// Boxes of what stands still and is bounded: side by side where they are few, in a tree where they are many; numbers are geometries.
  BoxArray still_boxes;
  std::unique_ptr<const Broadphase> still_tree;
  bool tree_of_moving = false;  ///< many pairs of which both move: each GeometryData has a tree of its own
  std::vector<int> listed;      ///< else those pairs, to be asked one by one
  std::vector<int> unbounded;   ///< pairs with half-spaces, whose box meets every other; and pairs that the user wants of what stands still

  GeometryReport report;

  bool moves(int geometry) const { return std::binary_search(moving.begin(), moving.end(), geometry); }
  /// -1 if the two are not checked against each other.
  int pairOf(int a, int b) const;
};

struct GeometryDataImpl {
  explicit GeometryDataImpl(const GeometryModel& geometry, int contacts);

  GeometryModel model;
  std::vector<SE3<double>> placement;  ///< by geometry, in the world
  std::vector<Vec3<double>> center;    ///< of bounding spheres, in the world
  std::vector<Bounds> bounds;          ///< in the world, grown by `margin`
  double margin = 0;                   ///< [m] of what moves: nearPairs() finds those that are no farther apart, too
  std::unique_ptr<Broadphase> moving;  ///< where the model asks for it
  std::vector<int> near_pairs;         ///< room for what the trees find
  std::vector<int> colliding;
  std::vector<Contact> contacts;
  std::vector<Distance> distances;
  std::vector<double> jacobian;  ///< 6 x nv
  int first = -1;

  void place(int geometry, const SE3<double>& oMg);
};

/// The pairs whose bounding boxes may meet, ascending.
const std::vector<int>& nearPairs(const GeometryImpl& m, GeometryDataImpl& d);

}  // namespace dyn
