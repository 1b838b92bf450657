// SPDX-License-Identifier: BSD-2-Clause
// Locating and reading mesh and octree files, and convex hulls. Only the sources behind this header use assimp, octomap and qhull.
#pragma once

#include <dyn/model/geometry_description.hpp>

#include <string>
#include <vector>

namespace dyn {

/// Returns the path of the file that a uri names, or an empty string if there is no such file. "package://NAME/..." (and "model://") is searched in
/// `packages` and in the environment's ROS_PACKAGE_PATH and AMENT_PREFIX_PATH. Otherwise the uri is "file://" and a path, or a path alone; a relative
/// path starts at the folder of the file `beside`.
std::string resolveUri(const std::string& uri, const std::vector<std::string>& packages, const std::string& beside);

/// Throws Error(file) if the file cannot be read or is larger than 512 MB; the message then ends with `usual`, which says what size is normal.
void checkFileSize(const std::string& path, const std::string& usual);

/// Reads all triangles of an STL, OBJ, DAE or other file that assimp reads, and merges equal vertices. A child process reads the file, with limits of
/// time and memory that grow with the file. Throws Error(file | syntax) if the file is broken, larger than 512 MB or beyond those limits, or if it
/// has no triangle or a vertex that is not finite.
geometry::TriangleMesh readMesh(const std::string& path);

/// Reads the occupied leaves of an octomap file, .bt or .ot. Throws Error(file | syntax) if the file is broken or larger than 512 MB.
geometry::Voxels readOctree(const std::string& path);

/// Returns the corners of the convex hull of points, by qhull. Points that lie in a plane are all returned.
std::vector<Vec3<double>> hullCorners(const std::vector<Vec3<double>>& points);

/// True if the triangles bound a convex solid: each edge joins two triangles, and all vertices lie behind all triangles, to 1e-6 of the mesh's size.
bool boundsConvexSolid(const geometry::TriangleMesh& mesh);

}  // namespace dyn
