// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/files.hpp"

#include <octomap/octomap.h>

#include <bitset>
#include <cmath>
#include <fstream>
#include <locale>
#include <string>
#include <vector>

namespace dyn {

namespace {

constexpr std::size_t most_depth = 16;  ///< depth of octomap's trees, whose keys have 16 bits

struct Header {
  std::string id;
  std::size_t nodes = 0;
  double resolution = 0;
};

void skipLine(std::istream& file) {
  for (int c = file.get(); file && c != '\n'; c = file.get()) {
  }
}

/// Reads the header and leaves the stream where the nodes begin.
Header readHeader(std::istream& file, bool binary, const Where& where) {
  const std::string wanted = binary ? "# Octomap OcTree binary file" : "# Octomap OcTree file";
  std::string first, word;
  std::getline(file, first);
  Header header;
  bool has_nodes = false;
  while (file >> word && word != "data") {
    if (word == "id") {
      file >> header.id;
    } else if (word == "size") {
      has_nodes = static_cast<bool>(file >> header.nodes);
    } else if (word == "res") {
      file >> header.resolution;
    } else {
      skipLine(file);  // a comment
    }
  }
  skipLine(file);
  // A file without nodes may end with its header.
  if (!first.starts_with(wanted) || word != "data" || !has_nodes || !(header.resolution > 0) || !std::isfinite(header.resolution))
    throw Error(ErrorCode::syntax, "is no octree (octomap's .bt or .ot): it needs '" + wanted + "', then id, size, res and data", where);
  file.clear();
  // All types of trees are written the same way in .bt, so only .ot needs the right type.
  if (!binary && header.id != "OcTree" && header.id != "1")
    throw Error(ErrorCode::syntax, "is an octree of type '" + header.id + "', not of occupancies, 'OcTree'; convert it to .bt", where);
  return header;
}

struct Children {
  std::size_t all = 0;
  int read = 0;  ///< children that have a record of their own
};

/// In .bt each child has two bits, which mean: no child, free, occupied, or a node with children and a record. In .ot each child has a record.
Children childrenOf(bool binary, const char* record) {
  Children children;
  if (!binary) {
    children.all = std::bitset<8>(static_cast<unsigned char>(record[4])).count();
    children.read = static_cast<int>(children.all);
    return children;
  }
  for (int i = 0; i < 8; ++i) {
    const int kind = (static_cast<unsigned char>(record[i / 4]) >> (2 * (i % 4))) & 3;
    children.all += kind != 0 ? 1 : 0;
    children.read += kind == 3 ? 1 : 0;
  }
  return children;
}

/// Throws Error(syntax) unless the nodes form a tree of the promised number of nodes that is at most most_depth levels deep. Octomap itself recurses
/// as deep as the children's bits say, and takes a file that ends early for a smaller tree.
void checkNodes(std::istream& file, bool binary, std::size_t promised, const Where& where) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::syntax, why, where); };
  std::vector<int> open{1};  // number of nodes still to be read, by depth
  std::size_t nodes = 1;
  char record[5];
  while (!open.empty()) {
    if (open.back() == 0) {
      open.pop_back();
      continue;
    }
    --open.back();
    if (!file.read(record, binary ? 2 : 5)) refuse("ends early: it promises " + std::to_string(promised) + " nodes, and the last ones are missing");
    const Children children = childrenOf(binary, record);
    if (children.all == 0) continue;
    if (open.size() > most_depth) refuse("is broken: its tree is deeper than " + std::to_string(most_depth) + " levels");
    nodes += children.all;
    if (nodes > promised) refuse("is broken: it promises " + std::to_string(promised) + " nodes and has more");
    open.push_back(children.read);
  }
  if (nodes != promised) refuse("ends early: it promises " + std::to_string(promised) + " nodes and has " + std::to_string(nodes));
}

}  // namespace

geometry::Voxels readOctree(const std::string& path) {
  const Where where{path, 0, ""};
  checkFileSize(path, "an octree for collision should have thousands of leaves");
  const bool binary = path.ends_with(".bt");
  std::ifstream file(path, std::ios::binary);
  file.imbue(std::locale::classic());
  if (!file) throw Error(ErrorCode::file, "cannot be read", where);
  const Header header = readHeader(file, binary, where);
  geometry::Voxels voxels;
  if (header.nodes == 0) return voxels;
  const std::istream::pos_type first = file.tellg();
  checkNodes(file, binary, header.nodes, where);
  file.seekg(first);
  octomap::OcTree tree(header.resolution);
  binary ? tree.readBinaryData(file) : tree.readData(file);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf)
    if (tree.isNodeOccupied(*leaf)) voxels.cubes.push_back({{leaf.getX(), leaf.getY(), leaf.getZ()}, leaf.getSize()});
  return voxels;
}

}  // namespace dyn
