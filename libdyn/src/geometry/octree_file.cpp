#include "geometry/files.hpp"

#include <octomap/octomap.h>

#include <fstream>
#include <memory>
#include <string>

namespace dyn {

namespace {

/// How many nodes the header promises: octomap takes a file that ends early for a smaller tree.
std::size_t promisedNodes(const std::string& path) {
  std::ifstream file(path);
  std::string word;
  std::size_t nodes = 0;
  while (file >> word && word != "data") {
    if (word == "size") file >> nodes;
  }
  return nodes;
}

std::unique_ptr<octomap::AbstractOcTree> read(const std::string& path, bool binary) {
  if (!binary) return std::unique_ptr<octomap::AbstractOcTree>(octomap::AbstractOcTree::read(path));
  auto tree = std::make_unique<octomap::OcTree>(1.0);
  if (!tree->readBinary(path)) return nullptr;
  return tree;
}

}  // namespace

geometry::Voxels readOctree(const std::string& path) {
  const Where where{path, 0, ""};
  const bool binary = path.ends_with(".bt");
  std::unique_ptr<octomap::AbstractOcTree> any;
  try {
    any = read(path, binary);
  } catch (const std::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is no octree: ") + e.what(), where);
  }
  const auto* tree = dynamic_cast<const octomap::OcTree*>(any.get());
  if (tree == nullptr) throw Error(ErrorCode::syntax, "is no octree of occupancies (octomap's .bt or .ot), or ends early", where);
  const std::size_t promised = promisedNodes(path);
  if (tree->size() != promised)
    throw Error(ErrorCode::syntax, "ends early: it promises " + std::to_string(promised) + " nodes and has " + std::to_string(tree->size()), where);
  geometry::Voxels voxels;
  for (auto leaf = tree->begin_leafs(); leaf != tree->end_leafs(); ++leaf)
    if (tree->isNodeOccupied(*leaf)) voxels.cubes.push_back({{leaf.getX(), leaf.getY(), leaf.getZ()}, leaf.getSize()});
  return voxels;
}

}  // namespace dyn
