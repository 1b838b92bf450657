// SPDX-License-Identifier: BSD-2-Clause
#include "compile/parts.hpp"
#include "model/universe.hpp"

#include <dyn/compile/edit.hpp>

#include <unordered_set>

namespace dyn {

namespace {

/// Gives the names in a constraint of an appended model their prefix. The appended model's universe becomes the place where it is attached.
void moveConstraint(ConstraintDescription& c, const std::string& prefix, const std::string& at, const SE3<double>& placement) {
  const auto moveFrame = [&](std::string& frame, SE3<double>& pose) {
    if (frame == "universe") {
      frame = at;
      pose = placement * pose;
    } else {
      frame = prefix + frame;
    }
  };
  if (auto* frames = std::get_if<FrameConstraint>(&c.relation)) {
    moveFrame(frames->frame, frames->placement);
    moveFrame(frames->other, frames->other_placement);
  } else if (auto* coupling = std::get_if<JointCoupling>(&c.relation)) {
    coupling->joint = prefix + coupling->joint;
    coupling->coupling.master = prefix + coupling->coupling.master;
  } else {
    auto& lock = std::get<JointLock>(c.relation);
    lock.joint = prefix + lock.joint;
  }
}

/// Appends the copy's groups and named states under names with the prefix. Its virtual joints end where the copy is attached, so they are left out.
void appendGroups(Model& out, const Model& other, const std::string& prefix) {
  const auto rename = [&](std::string& name) {
    if (!name.empty() && name != other.bodies[0].name) name = prefix + name;
  };
  const auto renameAll = [&](std::vector<std::string>& names) {
    for (std::string& name : names) rename(name);
  };
  std::unordered_set<std::string> names;
  for (const GroupDescription& group : out.groups) names.insert(group.name);
  for (GroupDescription group : other.groups) {
    rename(group.name);
    if (!names.insert(group.name).second) throw Error(ErrorCode::model, "append: '" + group.name + "' would be there twice; give the copy a prefix");
    renameAll(group.bodies);
    renameAll(group.joints);
    renameAll(group.groups);
    for (Chain& chain : group.chains) {
      rename(chain.base);
      rename(chain.tip);
    }
    out.groups.push_back(std::move(group));
  }
  for (EndEffectorDescription e : other.end_effectors) {
    for (std::string* name : {&e.name, &e.group, &e.body, &e.parent_group}) rename(*name);
    out.end_effectors.push_back(std::move(e));
  }
  for (const std::string& joint : other.passive_joints) out.passive_joints.push_back(prefix + joint);
  for (ConfigurationDescription state : other.configurations) {
    rename(state.name);
    rename(state.group);
    for (JointState& joint : state.joints) rename(joint.joint);
    out.configurations.push_back(std::move(state));
  }
  for (DeviceDescription device : other.devices) {
    rename(device.name);
    out.devices.push_back(std::move(device));
  }
}

}  // namespace

Model append(const Model& model, const Model& other, const std::string& at, const SE3<double>& placement, const std::string& prefix) {
  requireUniverse(model);
  requireUniverse(other);
  Model out = model;
  int carrier = out.findBody(at);
  SE3<double> pose = placement;
  for (const FrameDescription& frame : model.frames) {
    if (carrier >= 0 || frame.name != at) continue;
    carrier = frame.body;
    pose = frame.placement * placement;
  }
  if (carrier < 0) throw Error(ErrorCode::model, "append: there is no body or frame '" + at + "'");
  std::unordered_set<std::string> bodies, joints;
  for (const BodyDescription& b : out.bodies) {
    bodies.insert(b.name);
    joints.insert(b.joint.name);
  }
  for (const FrameDescription& f : out.frames) bodies.insert(f.name);
  const auto unique = [](std::unordered_set<std::string>& names, const std::string& name) {
    if (!names.insert(name).second) throw Error(ErrorCode::model, "append: '" + name + "' would be there twice; give the copy a prefix");
  };
  const int offset = static_cast<int>(out.bodies.size()) - 1;
  // Whatever was fixed to the copy's world is fixed where the copy is attached.
  const auto rehang = [&](int& body, SE3<double>& X) {
    if (body == 0) {
      X = pose * X;
      body = carrier;
    } else {
      body += offset;
    }
  };
  for (std::size_t i = 1; i < other.bodies.size(); ++i) {
    BodyDescription body = other.bodies[i];
    body.name = prefix + body.name;
    body.joint.name = prefix + body.joint.name;
    visitParts(body.joint, body.joint.name, [&](JointDescription& joint, const auto&) {
      if (!joint.coupling.type.empty()) joint.coupling.master = prefix + joint.coupling.master;
    });
    unique(bodies, body.name);
    unique(joints, body.joint.name);
    rehang(body.parent, body.joint.placement);
    out.bodies.push_back(std::move(body));
  }
  for (FrameDescription frame : other.frames) {
    frame.name = prefix + frame.name;
    unique(bodies, frame.name);
    rehang(frame.body, frame.placement);
    out.frames.push_back(std::move(frame));
  }
  std::unordered_set<std::string> names;
  for (const ConstraintDescription& c : out.constraints) names.insert(c.name);
  for (ConstraintDescription c : other.constraints) {
    c.name = prefix + c.name;
    unique(names, c.name);
    moveConstraint(c, prefix, at, placement);
    out.constraints.push_back(std::move(c));
  }
  names.clear();
  for (const GeometryDescription& g : out.geometries) names.insert(g.name);
  for (GeometryDescription g : other.geometries) {
    g.name = prefix + g.name;
    unique(names, g.name);
    rehang(g.body, g.placement);
    out.geometries.push_back(std::move(g));
  }
  // Collisions disabled with the copy's world are disabled with the volumes that were fixed to it, not with the body that carries them now.
  const auto renamed = [&](const std::string& name) {
    if (name != other.bodies[0].name) return std::vector<std::string>{prefix + name};
    std::vector<std::string> volumes;
    for (const GeometryDescription& g : other.geometries)
      if (g.body == 0 && g.role == GeometryDescription::Role::collision) volumes.push_back(prefix + g.name);
    return volumes;
  };
  for (const DisabledCollision& d : other.disabled_collisions)
    for (const std::string& first : renamed(d.body))
      for (const std::string& second : renamed(d.other)) out.disabled_collisions.push_back({first, second, d.reason});
  appendGroups(out, other, prefix);
  for (const std::string& note : other.notes) out.notes.push_back(note);
  return out;
}

}  // namespace dyn
