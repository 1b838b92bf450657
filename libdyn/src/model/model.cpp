// SPDX-License-Identifier: BSD-2-Clause
#include "model/universe.hpp"

#include <utility>

namespace dyn {

Model::Model() {
  BodyDescription universe;
  universe.name = "universe";
  universe.parent = -1;
  bodies.push_back(std::move(universe));
}

int Model::addBody(const std::string& body, int parent, JointDescription joint, const Inertia<double>& inertia) {
  requireUniverse(*this);
  if (parent < 0 || parent >= static_cast<int>(bodies.size()))
    throw Error(ErrorCode::argument, "body '" + body + "': parent " + std::to_string(parent) + " does not exist; bodies 0 to " +
                                         std::to_string(bodies.size() - 1) + " do");
  BodyDescription description;
  description.name = body;
  description.parent = parent;
  description.where = joint.where;
  description.joint = std::move(joint);
  description.inertia = inertia;
  bodies.push_back(std::move(description));
  return static_cast<int>(bodies.size()) - 1;
}

int Model::addFrame(const std::string& frame, int body, const SE3<double>& placement) {
  if (body < 0 || body >= static_cast<int>(bodies.size()))
    throw Error(ErrorCode::argument, "frame '" + frame + "': body " + std::to_string(body) + " does not exist");
  frames.push_back({frame, body, placement});
  return static_cast<int>(frames.size()) - 1;
}

int Model::addGeometry(const std::string& geometry, int body, const SE3<double>& placement, GeometryShape shape) {
  if (body < 0 || body >= static_cast<int>(bodies.size()))
    throw Error(ErrorCode::argument, "geometry '" + geometry + "': body " + std::to_string(body) + " does not exist");
  geometries.push_back({geometry, body, placement, std::move(shape), GeometryDescription::Role::collision, {}});
  return static_cast<int>(geometries.size()) - 1;
}

int Model::findBody(const std::string& body) const {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].name == body) return static_cast<int>(i);
  return -1;
}

int Model::findJoint(const std::string& joint) const {
  for (std::size_t i = 1; i < bodies.size(); ++i)
    if (bodies[i].joint.name == joint) return static_cast<int>(i);
  return -1;
}

int Model::findGeometry(const std::string& geometry) const {
  for (std::size_t i = 0; i < geometries.size(); ++i)
    if (geometries[i].name == geometry && geometries[i].role == GeometryDescription::Role::collision) return static_cast<int>(i);
  return -1;
}

}  // namespace dyn
