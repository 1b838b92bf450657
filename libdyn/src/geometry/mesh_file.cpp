// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/files.hpp"
#include "trial_process.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <new>

namespace dyn {

namespace {

/// Merges equal vertices: STL stores one vertex for each corner of each triangle.
class Collector {
 public:
  int vertex(const aiVector3D& x) {
    const std::array<double, 3> key{x.x, x.y, x.z};
    const auto [found, is_new] = index_.emplace(key, static_cast<int>(mesh.vertices.size()));
    if (is_new) mesh.vertices.push_back({key[0], key[1], key[2]});
    return found->second;
  }
  geometry::TriangleMesh mesh;

 private:
  std::map<std::array<double, 3>, int> index_;
};

geometry::TriangleMesh readByAssimp(const std::string& path, const Where& where) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  // Meshes of robots are drawn in the link's own axes, so the file's up direction is ignored.
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, true);
  const aiScene* scene =
      importer.ReadFile(path, aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_RemoveComponent | aiProcess_PreTransformVertices);
  if (scene == nullptr) throw Error(ErrorCode::syntax, std::string("is no mesh that can be read: ") + importer.GetErrorString(), where);

  Collector out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      std::array<int, 3> triangle{};
      for (unsigned k = 0; k < 3; ++k) {
        if (face.mIndices[k] >= mesh.mNumVertices) throw Error(ErrorCode::syntax, "names a vertex that it does not have", where);
        const aiVector3D& x = mesh.mVertices[face.mIndices[k]];
        if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z))
          throw Error(ErrorCode::syntax, "has a vertex that is not finite", where);
        triangle[k] = out.vertex(x);
      }
      out.mesh.triangles.push_back(triangle);
    }
  }
  if (out.mesh.triangles.empty()) throw Error(ErrorCode::syntax, "has no triangles", where);
  return std::move(out.mesh);
}

template <class T>
std::string bytesOf(const std::vector<T>& items) {
  return {reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T)};
}

/// Removes `count` items from the front of a report and returns them.
template <class T>
std::vector<T> itemsOf(std::string_view& bytes, std::uint64_t count) {
  std::vector<T> items(count);
  std::memcpy(items.data(), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return items;
}

}  // namespace

geometry::TriangleMesh readMesh(const std::string& path) {
  const Where where{path, 0, ""};
  checkFileSize(path, "a mesh for collision should have thousands of triangles");
  const double megabytes = static_cast<double>(std::filesystem::file_size(path)) * 0x1p-20;
  // Reading a valid file of ten million bytes takes about a second.
  const TrialLimits limits{.seconds = 5 + megabytes, .memory = static_cast<rlim_t>((2048 + 64 * megabytes) * 0x1p20)};
  using Counts = std::array<std::uint64_t, 2>;  // numbers of vertices and triangles; without vertices an error's text follows
  const Trial trial = tryInProcess(limits, [&](const auto& report) {
    std::string why;
    try {
      const geometry::TriangleMesh mesh = readByAssimp(path, {});
      report(bytesOf(std::vector{Counts{mesh.vertices.size(), mesh.triangles.size()}}));
      report(bytesOf(mesh.vertices));
      report(bytesOf(mesh.triangles));
      return;
    } catch (const std::bad_alloc&) {
      why = "is a mesh that takes more memory than one of its size should";
    } catch (const std::exception& e) {
      why = e.what();
    }
    report(bytesOf(std::vector{Counts{}}) + why);
  });
  if (!trial.untried.empty()) throw Error(ErrorCode::file, trial.untried, where);
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::syntax, why, where); };
  if (trial.late) refuse("is a mesh that cannot be read within " + std::to_string(static_cast<int>(limits.seconds)) + " s");
  if (trial.signal != 0) refuse(std::string("is a mesh that crashes its reader, assimp: ") + strsignal(trial.signal));
  std::string_view bytes = trial.report;
  if (bytes.size() < sizeof(Counts)) refuse("is a mesh that ends its reader, assimp");
  const Counts counts = itemsOf<Counts>(bytes, 1)[0];
  if (counts[0] == 0) refuse(std::string(bytes));
  // The child may have died within its report by a signal that is unknown here, because other code waited for the child.
  if (bytes.size() != counts[0] * sizeof(Vec3<double>) + counts[1] * sizeof(std::array<int, 3>)) refuse("is a mesh that ends its reader, assimp");
  geometry::TriangleMesh mesh;
  mesh.vertices = itemsOf<Vec3<double>>(bytes, counts[0]);
  mesh.triangles = itemsOf<std::array<int, 3>>(bytes, counts[1]);
  return mesh;
}

}  // namespace dyn
