// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes mesh and octree files. The first byte chooses the format. libdyn reads meshes in a separate process.
#include "fuzz.hpp"

#include <dyn/dyn.hpp>
#include <dyn/geometry/distance.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static constexpr const char* endings[] = {".stl", ".obj", ".dae", ".ply", ".off", ".bt", ".ot"};
  static const JointRegistry registry = JointRegistry::standard();
  static const std::filesystem::path folder = fuzz::scratchFolder();
  fuzz::Choices choices(data, size);
  const int kind = choices.below(static_cast<int>(std::size(endings)));
  const std::string path = folder / (std::string("file") + endings[kind]);
  std::ofstream(path, std::ios::binary) << choices.rest();
  Model description;
  description.addGeometry("file", 0, {}, kind < 5 ? GeometryShape(geometry::MeshFile{path}) : GeometryShape(geometry::OctreeFile{path}));
  JointDescription joint;
  joint.name = joint.type = "free_flyer";
  description.addGeometry("ball", description.addBody("body", 0, joint, {1, {}, {1, 0, 1, 0, 0, 1}}), {}, geometry::Sphere{0.1});
  fuzz::succeeds([&] {
    const CompactModel model = compile(description, registry);
    const GeometryModel volumes = compileGeometry(model, description);
    Data state(model);
    GeometryData placed(volumes);
    updateGeometryPlacements(model, state, volumes, placed, neutral(model));
    computeDistances(volumes, placed);
  });
  return 0;
}
