// SPDX-License-Identifier: BSD-2-Clause
// Writes what urdfdom has read as URDF again, with all digits, for libdyn's own reader. So there is one text of the format's rules.
#include <dyn/parsers/urdfdom.hpp>

#include <tinyxml2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>

namespace dyn::urdf {

namespace {

/// Returns the shortest text that reads back to the same number.
std::string textOf(double x) {
  std::array<char, 32> out{};
  return {out.data(), std::to_chars(out.data(), out.data() + out.size(), x).ptr};
}
std::string textOf(const ::urdf::Vector3& x) { return textOf(x.x) + " " + textOf(x.y) + " " + textOf(x.z); }

class Writer {
 public:
  std::string write(const ::urdf::ModelInterface& robot) {
    open("robot");
    put("name", robot.getName());
    for (const auto& [name, link] : robot.links_) writeLink(name, *link);
    for (const auto& [name, joint] : robot.joints_) writeJoint(name, *joint);
    close();
    return out_.CStr();
  }

 private:
  void open(const char* element) { out_.OpenElement(element, true); }
  void close() { out_.CloseElement(true); }
  void put(const char* attribute, const std::string& value) { out_.PushAttribute(attribute, value.c_str()); }
  void put(const char* attribute, double value) { put(attribute, textOf(value)); }
  /// Writes an element that has one attribute.
  template <class Value>
  void element(const char* name, const char* attribute, const Value& value) {
    open(name);
    put(attribute, value);
    close();
  }

  void writeOrigin(const ::urdf::Pose& pose) {
    open("origin");
    put("xyz", textOf(pose.position));
    const ::urdf::Rotation& q = pose.rotation;
    put("quat_xyzw", textOf(q.x) + " " + textOf(q.y) + " " + textOf(q.z) + " " + textOf(q.w));
    close();
  }

  void writeLink(const std::string& name, const ::urdf::Link& link) {
    open("link");
    put("name", name);
    if (link.inertial) {
      const ::urdf::Inertial& i = *link.inertial;
      open("inertial");
      writeOrigin(i.origin);
      element("mass", "value", i.mass);
      open("inertia");
      for (const auto& [entry, value] : {std::pair{"ixx", i.ixx}, {"ixy", i.ixy}, {"ixz", i.ixz}, {"iyy", i.iyy}, {"iyz", i.iyz}, {"izz", i.izz}})
        put(entry, value);
      close();
      close();
    }
    for (const auto& collision : link.collision_array) writeVolume("collision", *collision);
    for (const auto& visual : link.visual_array) writeVolume("visual", *visual);
    close();
  }

  template <class Volume>
  void writeVolume(const char* role, const Volume& volume) {
    open(role);
    writeOrigin(volume.origin);
    open("geometry");
    if (volume.geometry) writeShape(*volume.geometry);
    close();
    close();
  }

  /// Writes nothing for a shape that libdyn does not know; the reader then notes that the volume has none.
  void writeShape(const ::urdf::Geometry& geometry) {
    if (const auto* sphere = dynamic_cast<const ::urdf::Sphere*>(&geometry)) {
      element("sphere", "radius", sphere->radius);
    } else if (const auto* box = dynamic_cast<const ::urdf::Box*>(&geometry)) {
      element("box", "size", textOf(box->dim));
    } else if (const auto* cylinder = dynamic_cast<const ::urdf::Cylinder*>(&geometry)) {
      open("cylinder");
      put("radius", cylinder->radius);
      put("length", cylinder->length);
      close();
    } else if (const auto* mesh = dynamic_cast<const ::urdf::Mesh*>(&geometry)) {
      open("mesh");
      put("filename", mesh->filename);
      put("scale", textOf(mesh->scale));
      close();
    }
  }

  void writeJoint(const std::string& name, const ::urdf::Joint& joint) {
    const bool bounded = joint.type == ::urdf::Joint::REVOLUTE || joint.type == ::urdf::Joint::PRISMATIC;
    open("joint");
    put("name", name);
    put("type", typeOf(joint));
    writeOrigin(joint.parent_to_joint_origin_transform);
    element("parent", "link", joint.parent_link_name);
    element("child", "link", joint.child_link_name);
    if (joint.type != ::urdf::Joint::FIXED && joint.type != ::urdf::Joint::FLOATING) element("axis", "xyz", textOf(joint.axis));
    if (joint.limits) writeLimits(*joint.limits, bounded);
    if (joint.dynamics) {
      open("dynamics");
      if (joint.dynamics->damping != 0) put("damping", joint.dynamics->damping);
      if (joint.dynamics->friction != 0) put("friction", joint.dynamics->friction);
      close();
    }
    if (joint.mimic) {
      open("mimic");
      put("joint", joint.mimic->joint_name);
      put("multiplier", joint.mimic->multiplier);
      put("offset", joint.mimic->offset);
      close();
    }
    close();
  }

  static const char* typeOf(const ::urdf::Joint& joint) {
    switch (joint.type) {
      case ::urdf::Joint::REVOLUTE:
        return "revolute";
      case ::urdf::Joint::CONTINUOUS:
        return "continuous";
      case ::urdf::Joint::PRISMATIC:
        return "prismatic";
      case ::urdf::Joint::FLOATING:
        return "floating";
      case ::urdf::Joint::PLANAR:
        return "planar";
      case ::urdf::Joint::FIXED:
        return "fixed";
      default:
        return "unknown";
    }
  }

  /// A template, because older versions of urdfdom do not have all limits.
  template <class Limits>
  void writeLimits(const Limits& limits, bool bounded) {
    // Newer versions have infinity for limits that the file does not give. URDF has no word for it but a number that no joint reaches.
    open("limit");
    if (bounded) {
      put("lower", std::isfinite(limits.lower) ? limits.lower : -std::numeric_limits<double>::max());
      put("upper", std::isfinite(limits.upper) ? limits.upper : std::numeric_limits<double>::max());
    }
    putFinite("effort", limits.effort);
    putFinite("velocity", limits.velocity);
    if constexpr (requires { limits.acceleration; }) putFinite("acceleration", limits.acceleration);
    if constexpr (requires { limits.deceleration; }) putFinite("deceleration", limits.deceleration);
    if constexpr (requires { limits.jerk; }) putFinite("jerk", limits.jerk);
    close();
  }
  void putFinite(const char* attribute, double value) {
    if (std::isfinite(value)) put(attribute, value);
  }

  tinyxml2::XMLPrinter out_{nullptr, true};
};

/// Removes the place in the text above, which the caller has never seen.
void forget(Where& where) { where = {"", 0, where.joint}; }

}  // namespace

Model fromUrdfdom(const ::urdf::ModelInterface& robot, const Options& options) {
  Model model = parse(Writer().write(robot), "urdfdom's model '" + robot.getName() + "'", options);
  for (BodyDescription& body : model.bodies) {
    forget(body.where);
    forget(body.joint.where);
  }
  for (GeometryDescription& geometry : model.geometries) forget(geometry.where);
  for (std::string& note : model.notes) {
    if (note.starts_with("line 1: ")) note.erase(0, 8);
    if (note.ends_with(", first at line 1")) note.erase(note.size() - 17);
  }
  return model;
}

}  // namespace dyn::urdf
