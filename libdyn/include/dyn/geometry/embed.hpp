// SPDX-License-Identifier: BSD-2-Clause
// Files of volumes as a part of the description, so that it can be saved and moved without them.
#pragma once

#include <dyn/model/model.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace dyn {

/// Choices of embedFiles().
struct EmbedOptions {
  std::vector<std::string> packages{};                        ///< folders of packages, as GeometryOptions::packages
  std::uintmax_t largest_file = std::uintmax_t{1024} * 1024;  ///< larger files stay files [bytes]
};

/// The result of embedFiles().
struct EmbedReport {
  int volumes = 0;                  ///< volumes that no longer need a file
  int files = 0;                    ///< files that were read for them
  std::vector<std::string> left{};  ///< volumes that still need their file, each with the uri and why
};

/// Replaces meshes and octrees in files by their contents: a mesh for collision with MeshFile::convex by a ConvexHull of its points, any other mesh
/// by a TriangleMesh, both scaled, and an octree by Voxels. Collisions and distances of the volumes stay the same to the bit. A mesh's colours and
/// textures, which libdyn does not read, are lost. Files that are missing or too large are left, and reported. Throws Error(file | syntax) for broken
/// files and Error(model) for scales that are zero or not finite; the model then is unchanged. Takes the time of reading each file once.
DYN_API EmbedReport embedFiles(Model& model, const EmbedOptions& options = {});

}  // namespace dyn
