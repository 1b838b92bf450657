// Meshes and octrees from files: where they are, and what is in them. The only geometry sources that know assimp and octomap are behind this.
#pragma once

#include <dyn/model/geometry_description.hpp>

#include <string>
#include <vector>

namespace dyn {

/// The path that a uri stands for: "package://NAME/..." (and "model://") through `packages` and the environment's ROS_PACKAGE_PATH and
/// AMENT_PREFIX_PATH, "file://", or a path, relative to the folder of `beside`. Empty if there is no such file.
std::string resolveUri(const std::string& uri, const std::vector<std::string>& packages, const std::string& beside);

/// Throws Error(file) for a file that cannot be read or is larger than 512 MB, of which `usual` says what it should be.
void checkFileSize(const std::string& path, const std::string& usual);

/// All triangles of an STL, OBJ, DAE or other file that assimp reads, equal vertices made one. It reads in a process of its own, with limits of time
/// and memory that grow with the file. Throws Error(file | syntax) for a file that is broken, larger than 512 MB, beyond those limits, or has no
/// triangle or a vertex that is not finite.
geometry::TriangleMesh readMesh(const std::string& path);

/// The occupied leaves of an octomap file, .bt or .ot. Throws Error(file | syntax) for a file that is broken or larger than 512 MB.
geometry::Voxels readOctree(const std::string& path);

/// The corners of the convex hull of points, by qhull; of points that lie in a plane, all of them.
std::vector<Vec3<double>> hullCorners(const std::vector<Vec3<double>>& points);

/// Whether triangles bound a convex solid: every side between two of them, and all vertices behind all of them, to 1e-6 of its size.
bool boundsConvexSolid(const geometry::TriangleMesh& mesh);

}  // namespace dyn
