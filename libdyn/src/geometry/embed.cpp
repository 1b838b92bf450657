// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/load.hpp"

#include <dyn/geometry/embed.hpp>

#include <filesystem>
#include <utility>

namespace dyn {

namespace {

/// Returns the contents of the file as a shape.
GeometryShape contentsOf(VolumeLoader& loader, const GeometryDescription& g) {
  const auto* mesh = std::get_if<geometry::MeshFile>(&g.shape);
  if (mesh == nullptr) return loader.octree(g);
  geometry::TriangleMesh triangles = loader.triangles(*mesh, g);
  // A picture needs the surface, whatever collides.
  if (mesh->convex && g.role == GeometryDescription::Role::collision) return geometry::ConvexHull{std::move(triangles.vertices)};
  return triangles;
}

std::string megabytes(std::uintmax_t bytes) {
  std::string text = std::to_string(static_cast<double>(bytes) * 0x1p-20);
  return text.substr(0, text.find('.') + 3) + " MB";
}

}  // namespace

EmbedReport embedFiles(Model& model, const EmbedOptions& options) {
  VolumeLoader loader(options.packages);
  EmbedReport report;
  std::vector<std::pair<std::size_t, GeometryShape>> shapes;
  for (std::size_t k = 0; k < model.geometries.size(); ++k) {
    const GeometryDescription& g = model.geometries[k];
    if (uriOf(g).empty()) continue;
    const auto leave = [&](const std::string& why) { report.left.push_back("'" + g.name + "' (" + uriOf(g) + "): " + why); };
    const std::string path = loader.pathOf(g);
    std::error_code error;
    const std::uintmax_t bytes = path.empty() ? 0 : std::filesystem::file_size(path, error);
    if (path.empty() || error) {
      leave("the file is not there");
    } else if (bytes > options.largest_file) {
      leave("the file has " + megabytes(bytes) + ", and the limit is " + megabytes(options.largest_file));
    } else {
      shapes.emplace_back(k, contentsOf(loader, g));
    }
  }
  for (auto& [k, shape] : shapes) model.geometries[k].shape = std::move(shape);
  report.volumes = static_cast<int>(shapes.size());
  report.files = loader.filesRead();
  return report;
}

}  // namespace dyn
