// SPDX-License-Identifier: BSD-2-Clause
#include "compile/parts.hpp"
#include "model/universe.hpp"

#include <dyn/compile/scene.hpp>
#include <dyn/error.hpp>
#include <dyn/near_names.hpp>

#include <algorithm>
#include <numeric>
#include <unordered_map>

namespace dyn {

namespace {

/// Bodies by every name that a scene may use. A joint may have the name of a body or frame, which need not be the one that it carries.
class Names {
 public:
  explicit Names(const Model& model) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      place_.emplace(model.bodies[i].name, static_cast<int>(i));
      if (i > 0) joint_.emplace(model.bodies[i].joint.name, static_cast<int>(i));
    }
    for (std::size_t i = 1; i < model.bodies.size(); ++i)
      visitParts(model.bodies[i].joint, model.bodies[i].joint.name,
                 [&](const auto&, const std::string& name) { joint_.emplace(name, static_cast<int>(i)); });
    for (const FrameDescription& frame : model.frames) place_.emplace(frame.name, frame.body);
  }
  /// The body of this name, or with a frame of this name, or else with a joint of this name. Throws Error(model) if there is none.
  int bodyOf(const std::string& name) const {
    const int body = place(name) < 0 ? joint(name) : place(name);
    if (body < 0) {
      std::vector<std::string> all;
      for (const Bodies* names : {&place_, &joint_})
        for (const auto& entry : *names) all.push_back(entry.first);
      std::sort(all.begin(), all.end());
      all.erase(std::unique(all.begin(), all.end()), all.end());  // a body and a joint may share a name
      throw Error(ErrorCode::model, "the scene speaks of '" + name + "', and there is no such joint, body or frame" + nearNames(name, all));
    }
    return body;
  }
  /// The body of this name, or with a frame of this name. It is -1 for an unknown name, which compile() reports.
  int place(const std::string& name) const { return find(place_, name); }
  /// The body that a joint, or a joint with a part of this name, carries. It is -1 for an unknown name.
  int joint(const std::string& name) const { return find(joint_, name); }
  /// Calls visit(body) for the body of each master on which this joint or a part of it depends.
  template <class Visit>
  void masters(const JointDescription& joint, const Visit& visit) const {
    visitParts(joint, joint.name, [&](const JointDescription& part, const auto&) {
      if (!part.coupling.type.empty()) visit(this->joint(part.coupling.master));
    });
  }

 private:
  using Bodies = std::unordered_map<std::string, int>;
  static int find(const Bodies& bodies, const std::string& name) {
    const auto found = bodies.find(name);
    return found == bodies.end() ? -1 : found->second;
  }

  Bodies place_, joint_;
};

/// Groups of bodies that move each other, by union-find. The world belongs to none.
class Islands {
 public:
  explicit Islands(std::size_t bodies) : parent_(bodies) { std::iota(parent_.begin(), parent_.end(), 0); }
  int of(int body) {
    while (parent_[static_cast<std::size_t>(body)] != body) {
      int& above = parent_[static_cast<std::size_t>(body)];
      above = parent_[static_cast<std::size_t>(above)];
      body = above;
    }
    return body;
  }
  void tie(int a, int b) {
    if (a > 0 && b > 0) parent_[static_cast<std::size_t>(of(a))] = of(b);
  }

 private:
  std::vector<int> parent_;
};

Islands tied(const Model& model, const Names& names, const std::vector<std::string>& touching) {
  Islands islands(model.bodies.size());
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    islands.tie(static_cast<int>(i), model.bodies[i].parent);
    names.masters(model.bodies[i].joint, [&](int master) { islands.tie(static_cast<int>(i), master); });
  }
  for (const ConstraintDescription& constraint : model.constraints) {
    if (const auto* frames = std::get_if<FrameConstraint>(&constraint.relation)) islands.tie(names.place(frames->frame), names.place(frames->other));
    if (const auto* coupling = std::get_if<JointCoupling>(&constraint.relation))
      islands.tie(names.joint(coupling->joint), names.joint(coupling->coupling.master));
  }
  int last = 0;  // the last one that moves: the world ties nothing together
  for (const std::string& name : touching) {
    const int body = names.bodyOf(name);
    islands.tie(last, body);
    if (body > 0) last = body;
  }
  return islands;
}

bool speaksOf(const ConstraintDescription& constraint, const std::vector<bool>& kept, const Names& names) {
  const auto stays = [&](int body) { return body <= 0 || kept[static_cast<std::size_t>(body)]; };
  if (const auto* frames = std::get_if<FrameConstraint>(&constraint.relation))
    return stays(names.place(frames->frame)) && stays(names.place(frames->other));
  if (const auto* coupling = std::get_if<JointCoupling>(&constraint.relation)) return stays(names.joint(coupling->joint));
  return stays(names.joint(std::get<JointLock>(constraint.relation).joint));
}

}  // namespace

Model keepForScene(const Model& model, const Scene& scene, std::vector<std::string>& report) {
  requireUniverse(model);
  if (scene.outputs.empty()) return model;
  const Names names(model);
  const std::size_t count = model.bodies.size();
  std::vector<bool> kept(count, false);
  kept[0] = true;
  if (scene.dynamics) {
    Islands islands = tied(model, names, scene.touching);
    std::vector<bool> wanted(count, false);
    for (const std::string& output : scene.outputs) wanted[static_cast<std::size_t>(islands.of(names.bodyOf(output)))] = true;
    for (std::size_t i = 1; i < count; ++i) kept[i] = wanted[static_cast<std::size_t>(islands.of(static_cast<int>(i)))];
  } else {
    // Bodies that carry an output are needed, and the masters of their joints.
    std::vector<int> needed;
    needed.reserve(scene.outputs.size());
    for (const std::string& output : scene.outputs) needed.push_back(names.bodyOf(output));
    while (!needed.empty()) {
      const auto body = static_cast<std::size_t>(needed.back());
      needed.pop_back();
      if (kept[body]) continue;
      kept[body] = true;
      needed.push_back(model.bodies[body].parent);
      names.masters(model.bodies[body].joint, [&](int master) { needed.push_back(master); });
      needed.erase(std::remove(needed.begin(), needed.end(), -1), needed.end());
    }
  }

  Model out;
  out.name = model.name;
  out.gravity = model.gravity;
  out.notes = model.notes;
  std::vector<int> number(count, 0);
  for (std::size_t i = 1; i < count; ++i) {
    if (!kept[i]) continue;
    BodyDescription body = model.bodies[i];
    body.parent = number[static_cast<std::size_t>(body.parent)];
    number[i] = static_cast<int>(out.bodies.size());
    out.bodies.push_back(std::move(body));
  }
  // An unknown body counts as present: compile() reports it.
  const auto present = [&](const std::string& name) {
    const int geometry = model.findGeometry(name);
    const int body = names.place(name) < 0 && geometry >= 0 ? model.geometries[static_cast<std::size_t>(geometry)].body : names.place(name);
    return body < 0 || kept[static_cast<std::size_t>(body)];
  };
  for (const DisabledCollision& d : model.disabled_collisions)
    if (present(d.body) && present(d.other)) out.disabled_collisions.push_back(d);
  for (const ConstraintDescription& constraint : model.constraints)
    if (scene.dynamics && speaksOf(constraint, kept, names)) out.constraints.push_back(constraint);
  const auto spoken = [&](const std::string& name) {
    const auto in = [&](const std::vector<std::string>& list) { return std::find(list.begin(), list.end(), name) != list.end(); };
    return in(scene.outputs) || in(scene.touching) || std::any_of(out.constraints.begin(), out.constraints.end(), [&](const auto& constraint) {
             const auto* frames = std::get_if<FrameConstraint>(&constraint.relation);
             return frames && (frames->frame == name || frames->other == name);
           });
  };
  for (const FrameDescription& frame : model.frames)
    if (kept[static_cast<std::size_t>(frame.body)] && spoken(frame.name))
      out.frames.push_back({frame.name, number[static_cast<std::size_t>(frame.body)], frame.placement});
  for (const GeometryDescription& geometry : model.geometries) {
    if (!kept[static_cast<std::size_t>(geometry.body)]) continue;
    out.geometries.push_back(geometry);
    out.geometries.back().body = number[static_cast<std::size_t>(geometry.body)];
  }
  report.push_back("scene: " + std::to_string(count - out.bodies.size()) + " of " + std::to_string(count - 1) + " bodies left out, " +
                   std::to_string(model.frames.size() - out.frames.size()) + " of " + std::to_string(model.frames.size()) + " frames, " +
                   std::to_string(model.constraints.size() - out.constraints.size()) + " of " + std::to_string(model.constraints.size()) +
                   " constraints");
  return out;
}

std::vector<std::string> islandsOf(const Model& model, const std::vector<std::string>& touching) {
  Islands islands = tied(model, Names(model), touching);
  std::vector<std::string> out;
  std::vector<bool> seen(model.bodies.size(), false);
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const auto island = static_cast<std::size_t>(islands.of(static_cast<int>(i)));
    if (!seen[island]) out.push_back(model.bodies[i].name);
    seen[island] = true;
  }
  return out;
}

}  // namespace dyn
