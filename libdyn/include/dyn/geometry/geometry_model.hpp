// SPDX-License-Identifier: BSD-2-Clause
// Volumes compiled for collision checks. compileGeometry() returns a GeometryModel.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct GeometryImpl;

/// Two names of geometries or bodies. A body stands for all its geometries.
struct PairName {
  std::string a, b;
};

struct GeometryOptions {
  enum class Pairs {
    all,  ///< except pairs of one rigid body, of neighbours, and pairs that the description disables
    none
  };
  enum class Missing { refuse, skip };

  Pairs pairs = Pairs::all;
  std::vector<PairName> add{}, remove{};  ///< applied after `pairs`, in this order; a pair added by name is checked whatever its bodies
  /// Folders that contain packages, or package folders themselves, for "package://". ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are searched after them.
  std::vector<std::string> packages{};
  Missing missing = Missing::refuse;  ///< for files that do not exist: an error that names all of them, or lines in the report
};

/// A geometry that belongs to a pair.
struct GeometryRecord {
  std::string name;
  std::string body;
  int joint = 0;          ///< its number in the CompactModel; 0 if the geometry does not move
  SE3<double> placement;  ///< in the joint's frame
};

/// Indices of two geometries, the smaller one first.
struct CollisionPair {
  int a = 0, b = 0;
};

/// Says what was left out and why.
struct GeometryReport {
  int described = 0, kept = 0;                             ///< geometries in the description, visual ones included, and in the compiled model
  int pairs = 0;                                           ///< pairs of collision geometries that are checked
  int rigid = 0, adjacent = 0, disabled = 0, removed = 0;  ///< left out: of one rigid body, of neighbours, disabled, removed by name
  int files_read = 0, files_not_needed = 0;
  std::vector<std::string> missing;  ///< geometries whose file does not exist, each with its uri
  std::vector<std::string> lines;    ///< the whole report in words
};

/// Immutable, cheap to copy and shareable between threads.
class DYN_API GeometryModel {
 public:
  explicit GeometryModel(std::shared_ptr<const GeometryImpl> impl);
  /// Moving copies, which is as cheap, so that no model is ever empty.
  GeometryModel(const GeometryModel&) = default;
  GeometryModel& operator=(const GeometryModel&) = default;

  const std::vector<GeometryRecord>& geometries() const;
  const std::vector<CollisionPair>& pairs() const;
  const GeometryReport& report() const;
  /// Index of a geometry by name, and of a pair by its geometries' names in any order; -1 if there is none.
  int geometryId(const std::string& name) const;
  int pairId(const std::string& a, const std::string& b) const;

  const GeometryImpl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const GeometryImpl> impl_;
};

/// Collects the collision volumes of `description`, from which `model` was compiled, and the pairs to check. Reads each file that a pair needs once.
/// Bodies connected by fixed joints are one rigid body. A rigid body and the body to which its joint is attached are neighbours; if that is fixed to
/// the world, other bodies fixed to the world are not. Held joints count as if they could move. Throws Error(model) for volumes without size,
/// names used twice, bodies that the model does not have, and more than 2^24 pairs; Error(argument) for pairs of unknown names; and
/// Error(file | syntax) for missing or broken files. O(n^2) in the number of geometries.
DYN_API GeometryModel compileGeometry(const CompactModel& model, const Model& description, const GeometryOptions& options = {});

}  // namespace dyn
