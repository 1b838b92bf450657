// SPDX-License-Identifier: BSD-2-Clause
// Meshes of <asset>, their mass properties, and the files that they are read from.
#pragma once

#include "settings.hpp"

#include <dyn/model/geometry_description.hpp>
#include <dyn/spatial/inertia.hpp>

#include <optional>
#include <string>
#include <unordered_map>

namespace dyn::mjcf {

/// How a mesh has mass. `legacy` adds the volumes of all pyramids with their absolute values; MuJoCo does this unless a file says otherwise.
enum class MeshInertia { convex, exact, legacy, shell };

/// Reads the triangles of a binary STL or of an OBJ file. Throws Error(file | syntax) for other or broken files, and beyond 128 MB.
geometry::TriangleMesh readTriangles(const std::string& path);

/// Returns the mass properties of a mesh with unit density: the mass is its volume, or its area for `shell`.
Inertia<long double> massProperties(const geometry::TriangleMesh& mesh, MeshInertia how);

struct Mesh {
  const XMLElement* element = nullptr;
  std::string file;  ///< seen from the folder of the main file; empty if the vertices stand in the model
  geometry::TriangleMesh written;
  Vec3<double> scale{1, 1, 1}, refpos{};
  Mat3<double> refturn = Mat3<double>::identity();
  bool turned = false;  ///< refturn is not the unit matrix
  MeshInertia inertia = MeshInertia::legacy;
};

class Meshes {
 public:
  Meshes(const Source& source, const Settings& settings) : s_(source), settings_(settings) {}

  /// Reads one <mesh>. Throws Error(syntax | model) for a mesh without a name and a file, and for a name that is used twice.
  void add(const Values& values);
  /// Returns the mesh that an element names. Throws Error(model) if there is none.
  const Mesh& find(const std::string& name, const XMLElement& user) const;

  /// Returns the mesh as a shape, and writes the shape's pose in the mesh's frame. As in MuJoCo, a mesh for collision is convex. Returns nothing for
  /// a file that is both turned and scaled unevenly, because a MeshFile cannot say that.
  std::optional<GeometryShape> shape(const Mesh& mesh, bool collision, const std::string& beside, SE3<long double>& pose) const;
  /// Returns the mass properties for unit density. Opens the mesh's file. Throws Error(file | syntax | model) if they cannot be computed.
  const Inertia<long double>& mass(const Mesh& mesh, MeshInertia how);

 private:
  /// Returns a vertex of the file in the mesh's frame.
  static Vec3<double> placed(const Mesh& mesh, const Vec3<double>& x);

  const Source& s_;
  const Settings& settings_;
  std::unordered_map<std::string, Mesh> meshes_;
  std::map<std::pair<const Mesh*, MeshInertia>, Inertia<long double>> mass_;
};

}  // namespace dyn::mjcf
