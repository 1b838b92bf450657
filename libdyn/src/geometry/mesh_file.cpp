#include "geometry/files.hpp"

#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <cmath>
#include <map>

namespace dyn {

namespace {

/// Equal vertices, which STL has one of for each corner, become one.
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

}  // namespace

geometry::TriangleMesh readMesh(const std::string& path) {
  const Where where{path, 0, ""};
  checkFileSize(path, "a mesh for collision should have thousands of triangles");
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_RVC_FLAGS, aiComponent_NORMALS | aiComponent_TANGENTS_AND_BITANGENTS | aiComponent_COLORS |
                                                          aiComponent_TEXCOORDS | aiComponent_BONEWEIGHTS | aiComponent_ANIMATIONS |
                                                          aiComponent_TEXTURES | aiComponent_LIGHTS | aiComponent_CAMERAS | aiComponent_MATERIALS);
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  // Robots' meshes are drawn in the link's own axes, whatever axis a file calls up.
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

}  // namespace dyn
