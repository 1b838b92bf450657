// SPDX-License-Identifier: BSD-2-Clause
#include "attached.hpp"

namespace dyn::reader {

Attached::Attached(const Model& model) : volumes(model.bodies.size()), frames(model.bodies.size()), children(model.bodies.size()) {
  if (model.bodies.empty()) throw Error(ErrorCode::model, "cannot be written: it has no bodies; bodies[0] is the world, which Model() makes");
  const auto checked = [](int body, std::size_t count, const char* what, const std::string& name) {
    if (body < 0 || static_cast<std::size_t>(body) >= count)
      throw Error(ErrorCode::model, std::string(what) + " '" + name + "' refers to body " + std::to_string(body) +
                                        (what[0] == 'b' ? ", which does not come before it" : ", which the model does not have"));
    return static_cast<std::size_t>(body);
  };
  for (std::size_t i = 1; i < model.bodies.size(); ++i) children[checked(model.bodies[i].parent, i, "body", model.bodies[i].name)].push_back(i);
  for (const GeometryDescription& g : model.geometries) volumes[checked(g.body, model.bodies.size(), "volume", g.name)].push_back(&g);
  for (const FrameDescription& f : model.frames) frames[checked(f.body, model.bodies.size(), "frame", f.name)].push_back(&f);
}

}  // namespace dyn::reader
