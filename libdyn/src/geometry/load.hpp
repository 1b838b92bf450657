// SPDX-License-Identifier: BSD-2-Clause
// Builds volumes from their descriptions; each file is read once.
#pragma once

#include "geometry/volume.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace dyn {

/// Returns the uri of a mesh or octree file; an empty string for other shapes.
std::string uriOf(const GeometryDescription& g);

class VolumeLoader {
 public:
  explicit VolumeLoader(const std::vector<std::string>& packages) : packages_(packages) {}

  /// True if the geometry needs no file or its file exists.
  bool available(const GeometryDescription& g) const;
  /// Throws Error(model) for a volume without size, a number that is not finite, or a length outside 1e-75 m to 1e75 m, and Error(file | syntax) for
  /// a broken file.
  std::shared_ptr<const Volume> load(const GeometryDescription& g);
  /// The path of the geometry's file; an empty string if it does not exist.
  std::string pathOf(const GeometryDescription& g) const;
  /// The triangles of a geometry's mesh file, scaled. Throws as load().
  geometry::TriangleMesh triangles(const geometry::MeshFile& file, const GeometryDescription& g);
  /// The cubes of a geometry's octree file. Throws as load().
  geometry::Voxels octree(const GeometryDescription& g);
  int filesRead() const { return static_cast<int>(meshes_.size()) + octrees_; }

 private:
  std::shared_ptr<const Volume> fromMesh(const geometry::MeshFile& file, const GeometryDescription& g);
  std::shared_ptr<const Volume> fromOctree(const GeometryDescription& g);

  const std::vector<std::string>& packages_;
  std::map<std::string, geometry::TriangleMesh> meshes_;          ///< by path
  int octrees_ = 0;                                               ///< files of octrees that were read
  std::map<std::string, std::shared_ptr<const Volume>> volumes_;  ///< by path and, for meshes, scale and MeshFile::convex
};

}  // namespace dyn
