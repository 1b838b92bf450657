// SPDX-License-Identifier: BSD-2-Clause
// Pairs of volumes without collision checks, as bits of contype and conaffinity.
#pragma once

#include <dyn/model/model.hpp>

#include <unordered_map>
#include <utility>
#include <vector>

namespace dyn::mjcf {

/// MuJoCo checks two geoms if a bit of one's contype is in the other's conaffinity. Volumes that are checked against the same others form a class.
/// Class k has the k-th bit as its contype, and as its conaffinity the bits of the classes up to k that it is checked against. This says any relation
/// of up to 31 classes.
class Masks {
 public:
  /// Takes a time that grows with the third power of the number of volumes that are in a disabled pair.
  explicit Masks(const Model& model);

  /// contype and conaffinity of a volume for collision; 1 and 1, MuJoCo's default, where no volume is in a disabled pair.
  std::pair<int, int> of(const GeometryDescription& g) const;
  /// False if there are more classes than bits, or more than 500 volumes in disabled pairs. Then all volumes have the default.
  bool complete() const { return complete_; }

 private:
  bool classify(const Model& model, const std::vector<std::size_t>& volumes, const std::vector<std::vector<bool>>& apart);

  std::unordered_map<const GeometryDescription*, std::size_t> class_;  ///< of volumes in disabled pairs; that of the others is 0
  std::vector<std::vector<char>> checked_;                             ///< of two classes: whether they are checked against each other
  bool complete_ = true;
};

}  // namespace dyn::mjcf
