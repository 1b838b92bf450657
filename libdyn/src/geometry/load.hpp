// Compiled volumes of described ones; each file is read once.
#pragma once

#include "geometry/volume.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// Of a mesh or octree in a file; empty for others.
std::string uriOf(const GeometryDescription& g);

class VolumeLoader {
 public:
  explicit VolumeLoader(const std::vector<std::string>& packages) : packages_(packages) {}

  /// Whether the file that it needs, if any, is there.
  bool available(const GeometryDescription& g) const;
  /// Throws Error(model) for a volume without size or with numbers that are not finite, Error(file | syntax) for a broken file.
  std::shared_ptr<const Volume> load(const GeometryDescription& g);
  int filesRead() const { return static_cast<int>(meshes_.size() + octrees_.size()); }

 private:
  std::string pathOf(const GeometryDescription& g) const;
  std::shared_ptr<const Volume> fromMesh(const geometry::MeshFile& file, const GeometryDescription& g);
  std::shared_ptr<const Volume> fromOctree(const GeometryDescription& g);

  const std::vector<std::string>& packages_;
  std::map<std::string, geometry::TriangleMesh> meshes_;  ///< by path
  std::map<std::string, std::shared_ptr<const Volume>> octrees_;
  std::map<std::string, std::shared_ptr<const Volume>> scaled_;  ///< by path, scale and whether it is to be convex
};

}  // namespace dyn
