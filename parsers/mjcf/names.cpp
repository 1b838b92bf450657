// SPDX-License-Identifier: BSD-2-Clause
#include "names.hpp"

#include <unordered_set>

namespace dyn::mjcf {

namespace {

/// Names that are taken, and new ones that differ from all of them.
class Taken {
 public:
  void take(const std::string& name) { taken_.insert(name); }
  std::string make(std::string name) {
    while (!taken_.insert(name).second) name += '_';
    return name;
  }

 private:
  std::unordered_set<std::string> taken_;
};

}  // namespace

void nameAll(Scene& scene) {
  Model& model = scene.model;
  Taken bodies, joints, volumes;
  bodies.take(model.bodies[0].name);
  for (const BodyRecord& b : scene.bodies) bodies.take(b.name);
  for (const BodyDescription& b : model.bodies) joints.take(b.joint.name);
  for (const GeomRecord& g : scene.geoms) volumes.take(g.name);

  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    BodyRecord& b = scene.bodies[i];
    if (b.name.empty()) b.name = bodies.make("body_" + std::to_string(i));
    for (std::size_t k = b.first; k <= b.last && b.last < model.bodies.size(); ++k) {
      BodyDescription& body = model.bodies[k];
      JointDescription& joint = body.joint;
      const std::string own = b.name + (joint.type == "fixed" ? "_fixed" : "_joint");
      if (joint.name.empty())
        joint.name = joints.make(joint.type == "fixed" || b.first == b.last ? own : own + "_" + std::to_string(k - b.first + 1));
      joint.where.joint = joint.name;
      body.name = k == b.last ? b.name : bodies.make(b.name + "_" + joint.name);
    }
  }

  std::vector<int> sites(scene.bodies.size(), 0), solids(scene.bodies.size(), 0), pictures(scene.bodies.size(), 0);
  std::unordered_map<int, std::size_t> record;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) record.emplace(static_cast<int>(scene.bodies[i].last), i);
  for (FrameDescription& f : model.frames) {
    const std::size_t body = record.at(f.body);
    f.name = bodies.make(f.name.empty() ? scene.bodies[body].name + "_site_" + std::to_string(sites[body]++) : f.name);
  }
  for (std::size_t i = 0; i < scene.geoms.size(); ++i) {
    GeometryDescription& g = model.geometries[i];
    const std::size_t body = scene.geoms[i].body;
    const bool visual = g.role == GeometryDescription::Role::visual;
    int& count = visual ? pictures[body] : solids[body];
    const std::string own = scene.bodies[body].name + (visual ? "_visual_" : "_") + std::to_string(count);
    count += scene.geoms[i].name.empty();
    g.name = scene.geoms[i].name.empty() ? volumes.make(own) : scene.geoms[i].name;
  }
}

}  // namespace dyn::mjcf
