// SPDX-License-Identifier: BSD-2-Clause
#include "document.hpp"
#include "output.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn::urdf {

namespace {

using Numbers = std::vector<double>;

/// A vector of limits that URDF can say; empty if none of them limits anything.
Numbers finite(const Numbers& values, Output* out = nullptr, const std::string& joint = {}) {
  const auto infinite = [](double x) { return std::isinf(x); };
  if (std::all_of(values.begin(), values.end(), infinite)) return {};
  Numbers all = values;
  for (double& x : all) {
    if (!infinite(x)) continue;
    if (out) out->lose("infinite limits beside finite ones, which become the largest number", joint);
    x = std::copysign(std::numeric_limits<double>::max(), x);
  }
  return all;
}

const Numbers* numbersIn(const Parameters& parameters, const char* name) {
  const auto found = parameters.find(name);
  return found == parameters.end() ? nullptr : std::get_if<Numbers>(&found->second);
}

/// The parts of a joint that <joint> itself holds.
struct Plain {
  explicit Plain(const JointDescription& j, bool master_is_joint) {
    const std::string& t = j.type;
    one_axis = t == "revolute" || t == "prismatic" || t == "continuous";
    const auto* numbers = numbersIn(j.parameters, "axis");
    const bool has_axis = numbers && numbers->size() == 3 && j.parameters.size() == 1;
    type = (t == "fixed" || t == "free_flyer") ? j.parameters.empty() : (one_axis || t == "planar") && has_axis;
    if (type && has_axis) axis = *numbers;
    if (!one_axis) return;
    lower = finite(j.limits.lower);
    upper = finite(j.limits.upper);
    const bool single = lower.size() <= 1 && upper.size() <= 1;
    // <limit> without lower and upper means a range of zero, and one of them alone means zero for the other.
    range = t != "continuous" && single && lower.size() == 1 && upper.size() == 1;
    limit = range || t == "continuous";
    dissipation = j.damping.size() <= 1 && j.friction.size() <= 1;
    const auto* c = numbersIn(j.coupling.parameters, "coefficients");
    mimic = j.coupling.type == "mimic" && master_is_joint && c && c->size() == 2 && j.coupling.parameters.size() == 1;
    if (mimic) coefficients = *c;
  }
  bool one_axis = false;     ///< revolute, continuous or prismatic
  bool type = false;         ///< type and parameters
  bool range = false;        ///< lower and upper
  bool limit = false;        ///< velocity, effort and the like
  bool dissipation = false;  ///< damping and friction
  bool mimic = false;        ///< the coupling
  Numbers axis, lower, upper, coefficients;
};

struct Field {
  const char* name;
  Numbers values;
};

/// Values for which <joint> has no place.
std::vector<Field> others(const JointDescription& j, const Plain& plain, Output* out) {
  const JointLimits& l = j.limits;
  std::vector<Field> fields;
  const auto add = [&](const char* name, const Numbers& values, bool limit) {
    if (!values.empty()) fields.push_back({name, limit ? finite(values, out, j.name) : values});
  };
  if (!plain.range) {
    add("lower", l.lower, true);
    add("upper", l.upper, true);
  }
  for (const auto& [name, values] : {std::pair{"velocity", &l.velocity},
                                     {"effort", &l.effort},
                                     {"acceleration", &l.acceleration},
                                     {"deceleration", &l.deceleration},
                                     {"jerk", &l.jerk}})
    if (!plain.limit || values->size() > 1) add(name, *values, true);
  if (!plain.dissipation) {
    add("damping", j.damping, false);
    add("friction", j.friction, false);
  }
  add("armature", j.armature, false);
  fields.erase(std::remove_if(fields.begin(), fields.end(), [](const Field& f) { return f.values.empty(); }), fields.end());
  return fields;
}

void writePart(Output& out, const JointDescription& part, const std::string& owner);

void writeTyped(Output& out, const JointDescription& j, const std::vector<Field>& fields, const std::string& owner) {
  for (const Field& field : fields) out.put(field.name, field.values);
  writeParameters(out, j.parameters, owner);
  for (const auto& [name, value] : j.parameters) {
    const auto* parts = std::get_if<std::vector<JointDescription>>(&value);
    if (parts == nullptr) continue;
    if (name != "parts" || parts->empty()) out.lose("lists of joints that are not called 'parts'", owner);
    for (const JointDescription& part : *parts) writePart(out, part, owner);
  }
}

void writePart(Output& out, const JointDescription& part, const std::string& owner) {
  out.open("part");
  out.put("type", part.type);
  if (!part.name.empty()) out.put("name", part.name);
  out.putPose(part.placement);
  if (!part.coupling.type.empty()) out.lose("couplings of parts of joints", owner);
  writeTyped(out, part, others(part, Plain({}, false), &out), owner);
  out.close();
}

}  // namespace

void writeParameters(Output& out, const Parameters& parameters, const std::string& owner) {
  static constexpr const char* reserved[] = {"name",  "type",   "xyz",      "rpy",          "armature",     "damping", "friction", "lower",
                                             "upper", "effort", "velocity", "acceleration", "deceleration", "jerk",    "joint",    "master"};
  for (const auto& [name, value] : parameters) {
    const auto* numbers = std::get_if<Numbers>(&value);
    const auto* text = std::get_if<std::string>(&value);
    Numbers read;
    if (numbers == nullptr && text == nullptr) continue;
    if (std::find(std::begin(reserved), std::end(reserved), name) != std::end(reserved)) {
      out.lose("parameters called '" + name + "', which is a word of the extension", owner);
    } else if (numbers && numbers->empty()) {
      out.lose("parameters that are empty lists", owner);
    } else if (numbers) {
      out.put(name.c_str(), *numbers);
    } else if (onlyNumbers(*text, read)) {
      out.lose("texts that look like numbers", owner);
    } else {
      out.put(name.c_str(), *text);
    }
  }
}

void writeJoint(Output& out, const JointDescription& j, const std::string& parent, const std::string& child, bool master_is_joint) {
  const Plain plain(j, master_is_joint);
  out.open("joint");
  out.put("name", j.name);
  out.put("type", std::string(!plain.type || j.type == "free_flyer" ? "floating" : j.type));
  out.origin(j.placement);
  out.element("parent", "link", parent);
  out.element("child", "link", child);
  if (!plain.axis.empty()) out.element("axis", "xyz", plain.axis);
  const std::pair<const char*, const Numbers*> limits[] = {{"effort", &j.limits.effort},
                                                           {"velocity", &j.limits.velocity},
                                                           {"acceleration", &j.limits.acceleration},
                                                           {"deceleration", &j.limits.deceleration},
                                                           {"jerk", &j.limits.jerk}};
  const auto given = [](const auto& field) { return field.second->size() == 1 && std::isfinite((*field.second)[0]); };
  if (plain.type && (plain.range || (plain.limit && std::any_of(std::begin(limits), std::end(limits), given)))) {
    out.open("limit");
    if (plain.range) {
      out.put("lower", plain.lower);
      out.put("upper", plain.upper);
    }
    for (const auto& field : limits)
      if (given(field)) out.put(field.first, *field.second);
    out.close();
  }
  if (plain.type && plain.dissipation && (!j.damping.empty() || !j.friction.empty())) {
    out.open("dynamics");
    if (!j.damping.empty()) out.put("damping", j.damping);
    if (!j.friction.empty()) out.put("friction", j.friction);
    out.close();
  }
  if (plain.type && plain.mimic) {
    out.open("mimic");
    out.put("joint", j.coupling.master);
    out.put("multiplier", plain.coefficients[1]);
    out.put("offset", plain.coefficients[0]);
    out.close();
  }
  if (j.held) out.lose("marks of joints that reduce() holds", j.name);
  out.close();
}

bool needsExtension(const JointDescription& j, bool master_is_joint) {
  const Plain plain(j, master_is_joint);
  return !plain.type || !others(j, plain, nullptr).empty() || (!j.coupling.type.empty() && !plain.mimic);
}

void writeExtension(Output& out, const JointDescription& j, bool master_is_joint) {
  const Plain plain(j, master_is_joint);
  out.open("joint");
  out.put("name", j.name);
  out.put("type", j.type);
  // A type that <joint> cannot say leaves no values there.
  const std::vector<Field> fields = others(j, plain.type ? plain : Plain({}, false), &out);
  writeTyped(out, j, fields, j.name);
  if (!j.coupling.type.empty() && !(plain.type && plain.mimic)) {
    out.open("coupling");
    out.put("type", j.coupling.type);
    out.put("master", j.coupling.master);
    writeParameters(out, j.coupling.parameters, j.name);
    out.close();
  }
  out.close();
}

}  // namespace dyn::urdf
