// SPDX-License-Identifier: BSD-2-Clause
#include "names.hpp"

#include "common/reader.hpp"

namespace dyn::mjcf {

void nameAll(Scene& scene) {
  Model& model = scene.model;
  std::set<std::string> bodies, joints, volumes;
  bodies.insert(model.bodies[0].name);
  for (const BodyRecord& b : scene.bodies) bodies.insert(b.name);
  for (const BodyDescription& b : model.bodies) joints.insert(b.joint.name);
  for (const GeomRecord& g : scene.geoms) volumes.insert(g.name);

  for (std::size_t i = 1; i < scene.bodies.size(); ++i) {
    BodyRecord& b = scene.bodies[i];
    if (b.name.empty()) b.name = reader::freeName("body_" + std::to_string(i), bodies);
    for (std::size_t k = b.first; k <= b.last && b.last < model.bodies.size(); ++k) {
      BodyDescription& body = model.bodies[k];
      JointDescription& joint = body.joint;
      const std::string own = b.name + (joint.type == "fixed" ? "_fixed" : "_joint");
      if (joint.name.empty())
        joint.name = reader::freeName(joint.type == "fixed" || b.first == b.last ? own : own + "_" + std::to_string(k - b.first + 1), joints);
      joint.where.joint = joint.name;
      body.name = k == b.last ? b.name : reader::freeName(b.name + "_" + joint.name, bodies);
    }
  }

  std::vector<int> sites(scene.bodies.size(), 0), solids(scene.bodies.size(), 0), pictures(scene.bodies.size(), 0);
  std::unordered_map<int, std::size_t> record;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) record.emplace(static_cast<int>(scene.bodies[i].last), i);
  for (FrameDescription& f : model.frames) {
    const std::size_t body = record.at(f.body);
    f.name = reader::freeName(f.name.empty() ? scene.bodies[body].name + "_site_" + std::to_string(sites[body]++) : f.name, bodies);
  }
  for (std::size_t i = 0; i < scene.geoms.size(); ++i) {
    GeometryDescription& g = model.geometries[i];
    const std::size_t body = scene.geoms[i].body;
    const bool visual = g.role == GeometryDescription::Role::visual;
    int& count = visual ? pictures[body] : solids[body];
    const std::string own = scene.bodies[body].name + (visual ? "_visual_" : "_") + std::to_string(count);
    count += scene.geoms[i].name.empty();
    g.name = scene.geoms[i].name.empty() ? reader::freeName(own, volumes) : scene.geoms[i].name;
  }
}

}  // namespace dyn::mjcf
