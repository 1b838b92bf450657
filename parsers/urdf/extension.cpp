// SPDX-License-Identifier: BSD-2-Clause
#include "extension.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;

/// Reads an attribute that describes the joint itself and is not a parameter of its type. Returns false for other attributes.
bool readCommon(const Document& document, const XMLElement& e, const char* attribute, JointDescription& joint) {
  const std::pair<const char*, std::vector<double>*> fields[] = {{"armature", &joint.armature},
                                                                 {"damping", &joint.damping},
                                                                 {"friction", &joint.friction},
                                                                 {"lower", &joint.limits.lower},
                                                                 {"upper", &joint.limits.upper},
                                                                 {"effort", &joint.limits.effort},
                                                                 {"velocity", &joint.limits.velocity},
                                                                 {"acceleration", &joint.limits.acceleration},
                                                                 {"deceleration", &joint.limits.deceleration},
                                                                 {"jerk", &joint.limits.jerk}};
  for (const auto& [name, field] : fields) {
    if (std::strcmp(name, attribute) != 0) continue;
    *field = document.numbers(e, attribute);
    return true;
  }
  return false;
}

void readParameters(const Document& document, const XMLElement& e, std::initializer_list<const char*> reserved, Parameters& parameters,
                    JointDescription* joint) {
  for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next()) {
    bool skip = false;
    for (const char* name : reserved) skip = skip || std::strcmp(a->Name(), name) == 0;
    if (skip || (joint && readCommon(document, e, a->Name(), *joint))) continue;
    std::vector<double> numbers;
    if (onlyNumbers(a->Value(), numbers)) {
      parameters[a->Name()] = numbers;
    } else {
      parameters[a->Name()] = std::string(a->Value());
    }
  }
}

SE3<double> poseOf(const Document& document, const XMLElement& e, const char* xyz, const char* rpy) {
  SE3<double> X;
  if (e.Attribute(xyz)) X.p = document.vector3(e, xyz);
  if (!e.Attribute(rpy)) return X;
  const Vec3<double> a = document.vector3(e, rpy);
  const auto c = [](double x) { return std::cos(static_cast<long double>(x)); };
  const auto s = [](double x) { return std::sin(static_cast<long double>(x)); };
  const long double cr = c(a.x), sr = s(a.x), cp = c(a.y), sp = s(a.y), cy = c(a.z), sy = s(a.z);
  const long double R[9] = {cy * cp,
                            cy * sp * sr - sy * cr,
                            cy * sp * cr + sy * sr,  //
                            sy * cp,
                            sy * sp * sr + cy * cr,
                            sy * sp * cr - cy * sr,  //
                            -sp,
                            cp * sr,
                            cp * cr};
  for (int i = 0; i < 9; ++i) X.R.m[i] = static_cast<double>(R[i]);
  return X;
}

JointDescription readPart(const Document& document, const XMLElement& e, int depth) {
  if (depth > 8) document.fail(e, "joints made of joints are nested deeper than 8");
  JointDescription part;
  part.type = document.text(e, "type");
  if (const char* name = e.Attribute("name")) part.name = name;
  part.placement = poseOf(document, e, "xyz", "rpy");
  part.where = document.where(e, part.name);
  readParameters(document, e, {"type", "name", "xyz", "rpy"}, part.parameters, &part);
  std::vector<JointDescription> parts;
  for (const XMLElement* p = e.FirstChildElement("part"); p; p = p->NextSiblingElement("part")) parts.push_back(readPart(document, *p, depth + 1));
  if (!parts.empty()) part.parameters["parts"] = std::move(parts);
  return part;
}

}  // namespace

SE3<double> poseOf(const Document& document, const XMLElement& e) {
  SE3<double> X = poseOf(document, e, "xyz", "rpy");
  if (!e.Attribute("quat_xyzw")) return X;
  if (e.Attribute("rpy")) document.fail(e, std::string("<") + e.Name() + "> has both rpy and quat_xyzw; give one of them");
  const std::vector<double> q = document.numbers(e, "quat_xyzw");
  if (q.size() != 4) document.fail(e, "quat_xyzw must be four numbers x y z w of length 1");
  const Quaternion<long double> turn{q[0], q[1], q[2], q[3]};
  const long double length = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w);
  if (!(std::fabs(length - 1) < 1e-3L)) document.fail(e, "quat_xyzw must be four numbers x y z w of length 1");
  X.R = cast<double>(turn.matrix());
  return X;
}

Extensions readExtensions(const Document& document, const Outline& outline) {
  Extensions extensions;
  for (const XMLElement* block = document.robot().FirstChildElement("libdyn"); block; block = block->NextSiblingElement("libdyn"))
    for (const XMLElement* e = block->FirstChildElement(); e; e = e->NextSiblingElement()) {
      if (std::strcmp(e->Name(), "loop") == 0 || std::strcmp(e->Name(), "gear") == 0) continue;
      if (std::strcmp(e->Name(), "joint") != 0)
        document.fail(*e, std::string("<libdyn> has no <") + e->Name() + ">; it has <joint>, <loop> and <gear>");
      const std::string name = document.text(*e, "name");
      if (!outline.joint.count(name)) document.fail(*e, "<libdyn> describes joint '" + name + "', which the robot does not have");
      if (!extensions.emplace(name, e).second) document.fail(*e, "<libdyn> describes joint '" + name + "' twice");
      document.text(*e, "type");
    }
  return extensions;
}

namespace {

/// Reads the directions that a loop leaves free: words of "x y z rx ry rz".
std::array<bool, 6> readFree(const Document& document, const XMLElement& e) {
  std::array<bool, 6> free{};
  const char* given = e.Attribute("free");
  std::istringstream words(given ? given : "");
  for (std::string word; words >> word;) {
    const char* names[] = {"x", "y", "z", "rx", "ry", "rz"};
    const auto found = std::find(std::begin(names), std::end(names), word);
    if (found == std::end(names)) document.fail(e, "free=\"" + word + "\" is no direction; directions are x y z rx ry rz");
    free[static_cast<std::size_t>(found - std::begin(names))] = true;
  }
  return free;
}

ConstraintDescription readLoop(const Document& document, const Outline& outline, const XMLElement& e) {
  const std::string frame = document.text(e, "link");
  const char* other = e.Attribute("other");
  for (const std::string& link : {frame, std::string(other ? other : outline.root)})
    if (!outline.link.count(link)) document.fail(e, "the loop names link '" + link + "', which the robot does not have");
  ConstraintDescription loop = closeLoop(document.text(e, "name"), frame, other ? other : "universe", readFree(document, e));
  auto& relation = std::get<FrameConstraint>(loop.relation);
  relation.placement = poseOf(document, e, "xyz", "rpy");
  relation.other_placement = poseOf(document, e, "other_xyz", "other_rpy");
  return loop;
}

ConstraintDescription readGear(const Document& document, const Outline& outline, const XMLElement& e) {
  const std::string joint = document.text(e, "joint");
  Coupling coupling;
  coupling.type = document.text(e, "type");
  coupling.master = document.text(e, "master");
  for (const std::string& name : {joint, coupling.master})
    if (!outline.joint.count(name)) document.fail(e, "the gear names joint '" + name + "', which the robot does not have");
  readParameters(document, e, {"joint", "type", "master", "position_gain", "velocity_gain"}, coupling.parameters, nullptr);
  return coupleJoint(joint, coupling);
}

}  // namespace

std::vector<ConstraintDescription> readConstraints(const Document& document, const Outline& outline) {
  std::vector<ConstraintDescription> out;
  for (const XMLElement* block = document.robot().FirstChildElement("libdyn"); block; block = block->NextSiblingElement("libdyn"))
    for (const XMLElement* e = block->FirstChildElement(); e; e = e->NextSiblingElement()) {
      const bool loop = std::strcmp(e->Name(), "loop") == 0;
      if (!loop && std::strcmp(e->Name(), "gear") != 0) continue;
      ConstraintDescription constraint = loop ? readLoop(document, outline, *e) : readGear(document, outline, *e);
      constraint.baumgarte = {document.number(*e, "position_gain", 0), document.number(*e, "velocity_gain", 0)};
      constraint.where = document.where(*e);
      out.push_back(std::move(constraint));
    }
  return out;
}

void applyExtension(const Document& document, const XMLElement& extension, JointDescription& joint) {
  const JointDescription before = joint;
  joint = readPart(document, extension, 0);
  joint.name = before.name;
  joint.placement = before.placement;
  joint.where = document.where(extension, before.name);
  // Values of the <joint> element stay where the extension gives none.
  for (auto field : {&JointDescription::armature, &JointDescription::damping, &JointDescription::friction})
    if ((joint.*field).empty()) joint.*field = before.*field;
  for (auto field : {&JointLimits::lower, &JointLimits::upper, &JointLimits::velocity, &JointLimits::effort, &JointLimits::acceleration,
                     &JointLimits::deceleration, &JointLimits::jerk})
    if ((joint.limits.*field).empty()) joint.limits.*field = before.limits.*field;
  joint.coupling = before.coupling;
  if (const XMLElement* coupling = extension.FirstChildElement("coupling")) {
    joint.coupling = {};
    joint.coupling.type = document.text(*coupling, "type");
    joint.coupling.master = document.text(*coupling, "master");
    readParameters(document, *coupling, {"type", "master"}, joint.coupling.parameters, nullptr);
  }
}

}  // namespace dyn::urdf
