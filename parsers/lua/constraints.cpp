// SPDX-License-Identifier: BSD-2-Clause
// RBDL's constraint sets: contacts of points with the world, and loops between frames of two bodies.
#include "parts.hpp"

#include <dyn/near_names.hpp>

#include <cmath>
#include <tuple>
#include <utility>

namespace dyn::lua {

namespace {

/// Marks the one coordinate that is not zero as constrained. A constraint's rows are along axes of a frame.
void constrain(const Value& direction, const std::vector<double>& x, std::array<bool, 6>& free, std::size_t first) {
  std::size_t count = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (x[k] == 0) continue;
    ++count;
    free[first + k] = false;
  }
  if (count != 1) direction.fail("must be along one axis of its frame; turn the frame so that it is");
}

/// Reads `one`, or each of the list `many`, as a direction.
template <class Read>
void eachDirection(const Value& constraint, const char* one, const char* many, const Read& read) {
  const Value single = constraint[one], list = constraint[many];
  if (single.exists() == list.exists()) constraint.fail(std::string("must have one of ") + one + " and " + many);
  if (single.exists()) return read(single);
  for (int k = 1, count = list.length(); k <= count; ++k) read(list[k]);
}

FrameConstraint contactOf(const Value& constraint, const Model& model, const Names& names) {
  constraint.noteOthers("contact", {"constraint_type", "name", "id", "body", "point", "point_name", "normal", "normal_sets", "enable_stabilization",
                                    "normal_acceleration", "stabilization_coefficient", "stabilization_parameter"});
  if (constraint["normal_acceleration"].number(0) != 0)
    constraint.notes().add("ignored: the normal_acceleration of a contact", constraint.where().line);
  FrameConstraint out;
  if (const Value point = constraint["point_name"]; point.exists()) {
    const FrameDescription& frame = names.frame(point, names.points, "point");
    out.frame = frame.name;
  } else {
    out.frame = model.bodies[static_cast<std::size_t>(names.body(constraint["body"]))].name;
    out.placement.p = constraint["point"].vector(Vec3<double>{});
  }
  out.axes = ConstraintAxes::LOCAL_WORLD_ALIGNED;
  out.free.fill(true);
  // Normals are in the world's axes.
  eachDirection(constraint, "normal", "normal_sets", [&](const Value& normal) { constrain(normal, normal.numbers(3), out.free, 0); });
  return out;
}

/// Reads one side of a loop: a named frame, or a body and a pose in it. Returns the name and the pose.
std::pair<std::string, SE3<double>> sideOf(const Value& constraint, const std::string& side, const Model& model, const Names& names) {
  const std::string local = side + "_local_frame", body = side + "_body", pose = side + "_transform";
  if (const Value frame = constraint[local.c_str()]; frame.exists()) return {names.frame(frame, names.frames, "local frame").name, SE3<double>{}};
  const int index = names.body(constraint[body.c_str()]);
  return {model.bodies[static_cast<std::size_t>(index)].name, constraint[pose.c_str()].pose()};
}

FrameConstraint loopOf(const Value& constraint, const Model& model, const Names& names) {
  constraint.noteOthers("loop", {"constraint_type", "name", "id", "predecessor_body", "predecessor_transform", "predecessor_local_frame",
                                 "successor_body", "successor_transform", "successor_local_frame", "axis", "axis_sets", "enable_stabilization",
                                 "stabilization_coefficient", "stabilization_parameter"});
  FrameConstraint out;
  std::tie(out.other, out.other_placement) = sideOf(constraint, "predecessor", model, names);
  std::tie(out.frame, out.placement) = sideOf(constraint, "successor", model, names);
  out.axes = ConstraintAxes::OTHER;  // RBDL's axes are those of the predecessor's frame
  out.has_target = true;
  out.free.fill(true);
  eachDirection(constraint, "axis", "axis_sets", [&](const Value& axis) {
    // RBDL lists the angular part first.
    const std::vector<double> s = axis.numbers(6);
    constrain(axis, {s[3], s[4], s[5], s[0], s[1], s[2]}, out.free, 0);
  });
  return out;
}

/// RBDL's feedback with time constant T is critically damped.
Baumgarte feedbackOf(const Value& constraint) {
  if (!constraint["enable_stabilization"].boolean(false)) return {};
  const Value value = constraint["stabilization_coefficient"];
  const double T = value.exists() ? value.number() : constraint["stabilization_parameter"].number(0.1);
  if (!(T > 0)) constraint.fail("its stabilization coefficient, a time in seconds, must be positive");
  return {1 / (T * T), 2 / T};
}

}  // namespace

std::vector<NamedConstraints> readConstraintSets(const Value& sets, const Model& model, const Names& names) {
  std::vector<NamedConstraints> out;
  if (!sets.exists()) return out;
  for (const std::string& name : sets.names()) {
    NamedConstraints read{name, {}};
    std::set<std::string> taken;
    const Value set = sets[name.c_str()];
    for (int k = 1, count = set.length(); k <= count; ++k) {
      const Value constraint = set[k];
      const std::string type = constraint["constraint_type"].text();
      if (type != "contact" && type != "loop")
        constraint.fail("is of the type '" + type + "'" + nearNames(type, {"contact", "loop"}) + "; constraints are a contact or a loop");
      ConstraintDescription description;
      description.name = reader::freeName(constraint["name"].text(name + "_" + std::to_string(k)), taken);
      description.where = constraint.where();
      description.relation = type == "contact" ? contactOf(constraint, model, names) : loopOf(constraint, model, names);
      if (type == "loop") description.baumgarte = feedbackOf(constraint);
      read.constraints.push_back(std::move(description));
    }
    out.push_back(std::move(read));
  }
  return out;
}

}  // namespace dyn::lua
