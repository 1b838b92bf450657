// SPDX-License-Identifier: BSD-2-Clause
// Contents of GeometryModel and GeometryData.
#pragma once

#include "geometry/broadphase.hpp"
#include "geometry/narrow/narrow.hpp"
#include "geometry/volume.hpp"

#include <dyn/geometry/collision.hpp>
#include <dyn/geometry/distance.hpp>

#include <algorithm>
#include <memory>
#include <unordered_map>
#include <vector>

namespace dyn {

struct GeometryImpl {
  std::shared_ptr<const CompactModel> model;  ///< the records refer to its joints
  std::vector<GeometryRecord> records;
  std::vector<std::shared_ptr<const Volume>> volumes;  ///< by geometry; geometries with the same file and scale share one
  std::unordered_map<std::string, int> index;          ///< by name
  std::vector<CollisionPair> pairs;                    ///< ascending
  std::vector<int> pairs_of;                           ///< pairs with first geometry a: from pairs_of[a] up to pairs_of[a + 1]
  NarrowPhase narrow;
  int nv = 0;

  std::vector<int> moving;  ///< geometries that move in the description, ascending
  /// Boxes of static bounded geometries, numbered by geometry. The array holds them if they are few, the tree if they are many.
  BoxArray still_boxes;
  std::unique_ptr<const Broadphase> still_tree;
  bool tree_of_moving = false;  ///< true for many pairs that both move: each GeometryData then has its own tree
  std::vector<int> listed;      ///< otherwise: pairs that both move, which are tested one by one
  std::vector<int> unbounded;   ///< pairs with a half-space, whose box overlaps every other, and pairs of static geometries that the user adds

  GeometryReport report;

  bool moves(int geometry) const { return std::binary_search(moving.begin(), moving.end(), geometry); }
  /// Returns the index of the pair of a and b; -1 if the two are not checked against each other.
  int pairOf(int a, int b) const;
};

struct GeometryDataImpl {
  explicit GeometryDataImpl(const GeometryModel& geometry, int contacts);

  GeometryModel model;
  std::vector<SE3<double>> placement;  ///< by geometry, in the world
  std::vector<Vec3<double>> center;    ///< of bounding spheres, in the world
  std::vector<Bounds> bounds;          ///< in the world, grown by `margin`
  double margin = 0;                   ///< [m] boxes that move grow by this, so nearPairs() also finds pairs this far apart
  std::unique_ptr<Broadphase> moving;  ///< tree of moving geometries; null unless the model has tree_of_moving
  std::vector<int> near_pairs;         ///< result of nearPairs()
  std::vector<int> colliding;
  std::vector<Contact> contacts;
  std::vector<Distance> distances;
  std::vector<double> jacobian;  ///< 6 x nv
  int first = -1;                ///< pair that the last anyCollision() found; -1: none

  void place(int geometry, const SE3<double>& oMg);
};

/// Returns the pairs whose bounding boxes may overlap, ascending.
const std::vector<int>& nearPairs(const GeometryImpl& m, GeometryDataImpl& d);

}  // namespace dyn
