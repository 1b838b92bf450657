// Volumes made ready for collision: what compileGeometry() returns, immutable, cheap to copy, shareable between threads.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn {

struct GeometryImpl;

/// Two geometries, or two bodies and with them all pairs of their geometries, by name.
struct PairName {
  std::string a, b;
};

struct GeometryOptions {
  enum class Pairs {
    all,  ///< but those of one rigid body, of neighbours, and those that the description disables
    none
  };
  enum class Missing { refuse, skip };

  Pairs pairs = Pairs::all;
  std::vector<PairName> add{}, remove{};  ///< after `pairs`, in this order; a pair that is asked for by name is checked whatever its bodies
  /// Folders of packages, or packages themselves, for "package://"; after them come ROS_PACKAGE_PATH and AMENT_PREFIX_PATH.
  std::vector<std::string> packages{};
  Missing missing = Missing::refuse;  ///< files that are not there: an error that names all of them, or a line in the report
};

/// A geometry that some pair needs.
struct GeometryRecord {
  std::string name;
  std::string body;
  int joint = 0;          ///< of the CompactModel; 0: it does not move
  SE3<double> placement;  ///< in the joint's frame
};

/// Indices of geometries, the first the smaller.
struct CollisionPair {
  int a = 0, b = 0;
};

/// What was left out and why.
struct GeometryReport {
  int described = 0, kept = 0;  ///< geometries, visual ones included
  int pairs = 0;                ///< kept, of the pairs of collision geometries:
  int rigid = 0, adjacent = 0, disabled = 0, removed = 0;
  int files_read = 0, files_not_needed = 0;
  std::vector<std::string> missing;  ///< geometries whose file is not there, each with the uri
  std::vector<std::string> lines;    ///< all that in words
};

class DYN_API GeometryModel {
 public:
  explicit GeometryModel(std::shared_ptr<const GeometryImpl> impl);
  /// Moving copies, which is as cheap: none is ever empty.
  GeometryModel(const GeometryModel&) = default;
  GeometryModel& operator=(const GeometryModel&) = default;

  const std::vector<GeometryRecord>& geometries() const;
  const std::vector<CollisionPair>& pairs() const;
  const GeometryReport& report() const;
  /// Index of a geometry by name, of a pair by its geometries' names in any order; -1 if it is not there.
  int geometryId(const std::string& name) const;
  int pairId(const std::string& a, const std::string& b) const;

  const GeometryImpl& impl() const { return *impl_; }

 private:
  std::shared_ptr<const GeometryImpl> impl_;
};

/// Collects the volumes of `description`, from which `model` was compiled, and the pairs of them to be checked; reads the files of those that
/// a pair needs, each once. Bodies that fixed joints connect are one rigid body; a rigid body and the one that its joint hangs on are neighbours. Of
/// what stands in the world only the body that the joint itself hangs on is. Joints that are held count as if they moved. Throws Error(model) for
/// volumes of no size, names used twice, bodies that the model does not have and more than 2^24 pairs, Error(argument) for pairs of unknown names,
/// Error(file | syntax) for files that are missing or broken. O(n^2) in the number of geometries.
DYN_API GeometryModel compileGeometry(const CompactModel& model, const Model& description, const GeometryOptions& options = {});

}  // namespace dyn
