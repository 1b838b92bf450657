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
  std::string a,  ///< one name
      b;          ///< the other name; the order does not matter
};

/// Choices of compileGeometry(): the pairs that it takes, the folders of files, and the functions that compare volumes.
struct GeometryOptions {
  /// The pairs to begin with.
  enum class Pairs {
    all,  ///< all pairs except those of one rigid body, of neighbours, and those that the description disables
    none  ///< no pair
  };
  /// How files that do not exist are treated.
  enum class Missing {
    refuse,  ///< throws one Error(file) that names all of them
    skip     ///< leaves their geometries out, with a line in the report for each
  };
  /// The functions that compare two volumes.
  enum class Narrow {
    own,  ///< libdyn's
    fcl   ///< FCL's signed distance (GJK and EPA) of two solids, triangles or cubes: slower and less exact. Volumes collide if FCL's GJK says
          ///< that two pieces overlap. The functions allocate, and throw Error(argument) naming the pair where FCL fails.
  };

  Pairs pairs = Pairs::all;     ///< pairs to begin with
  std::vector<PairName> add{},  ///< pairs to add to `pairs`, whatever their bodies
      remove{};                 ///< pairs to leave out after that
  /// Folders that contain packages, or package folders themselves, for "package://". ROS_PACKAGE_PATH and AMENT_PREFIX_PATH are searched after them.
  std::vector<std::string> packages{};
  Missing missing = Missing::refuse;  ///< for files that pairs need and that do not exist
  Narrow narrow = Narrow::own;        ///< which functions compare two volumes
  double fcl_tolerance = 1e-6;        ///< [m] FCL's distance_tolerance and its default. Errors for solids of 1 m reach about its square root.
};

/// A geometry that belongs to a pair.
struct GeometryRecord {
  std::string name;       ///< as described
  std::string body;       ///< name of the described body that it is on
  int joint = 0;          ///< its number in the CompactModel; 0 if the geometry does not move
  SE3<double> placement;  ///< in the joint's frame
};

/// A pair of geometries that is checked, by their indices, the smaller one first.
struct CollisionPair {
  int a = 0,  ///< index in geometries()
      b = 0;  ///< index in geometries()
};

/// Numbers of what compileGeometry() has kept and left out, and why.
struct GeometryReport {
  int described = 0,                 ///< geometries in the description, visual ones included
      kept = 0;                      ///< geometries in the compiled model
  int pairs = 0;                     ///< pairs of collision geometries that are checked
  int rigid = 0,                     ///< pairs left out because they are on one rigid body
      adjacent = 0,                  ///< pairs left out because their bodies are neighbours
      disabled = 0,                  ///< pairs left out because the description disables them
      removed = 0;                   ///< pairs removed by name
  int files_read = 0,                ///< files that were read
      files_not_needed = 0;          ///< files of geometries that are in no pair
  std::vector<std::string> missing;  ///< geometries whose file does not exist, each with its uri
  std::vector<std::string> lines;    ///< the whole report in words
};

/// Compiled geometries and the pairs to check. Immutable, cheap to copy and shareable between threads.
class DYN_API GeometryModel {
 public:
  /// Wraps compiled contents; compileGeometry() calls it.
  explicit GeometryModel(std::shared_ptr<const GeometryImpl> impl);
  /// Moving copies, which is as cheap, so that no model is ever empty.
  GeometryModel(const GeometryModel&) = default;
  GeometryModel& operator=(const GeometryModel&) = default;

  /// Returns the geometries, pairs or report.
  /// @{
  const std::vector<GeometryRecord>& geometries() const;
  const std::vector<CollisionPair>& pairs() const;
  const GeometryReport& report() const;
  /// @}
  /// Returns the index of a geometry by name, or of a pair by its geometries' names in any order; -1 if there is none.
  /// @{
  int geometryId(const std::string& name) const;
  int pairId(const std::string& a, const std::string& b) const;
  /// @}

  const GeometryImpl& impl() const { return *impl_; }  ///< implementation, internal to libdyn

 private:
  std::shared_ptr<const GeometryImpl> impl_;
};

/// Collects the collision volumes of `description`, from which `model` was compiled, and the pairs to check. Reads each file that a pair needs once.
/// Bodies connected by fixed joints are one rigid body. A rigid body and the body to which its joint is attached are neighbours; if that is fixed to
/// the world, other bodies fixed to the world are not. Held joints count as if they could move. Throws Error(model) for volumes without size,
/// names used twice, bodies that the model does not have, and more than 2^24 pairs; Error(argument) for pairs of unknown names, a
/// tolerance that is not positive, and pairs with a half-space if FCL compares them, because it has no distance to one; and Error(file | syntax) for
/// missing or broken files. O(n^2) in the number of geometries.
DYN_API GeometryModel compileGeometry(const CompactModel& model, const Model& description, const GeometryOptions& options = {});

}  // namespace dyn
