// SPDX-License-Identifier: BSD-2-Clause
#include "validate.hpp"

#include "extension.hpp"
#include "vocabulary.hpp"

#include <dyn/near_names.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_set>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;

constexpr const char* joint_types[] = {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"};

class Validator {
 public:
  Validator(const Document& document, Inertias inertias, std::vector<Error>& errors) : d_(document), inertias_(inertias), errors_(errors) {}

  Outline run() {
    for (const XMLElement* e = d_.robot().FirstChildElement(); e; e = e->NextSiblingElement()) guarded([&] { collect(*e); });
    guarded([&] { tree(); });
    for (const XMLElement* link : out_.links) guarded([&] { checkLink(*link); });
    for (const XMLElement* joint : out_.joints) guarded([&] { checkJoint(*joint); });
    for (const XMLElement* joint : out_.joints) guarded([&] { checkMimic(*joint); });
    noteUnread(d_);
    return std::move(out_);
  }

 private:
  /// Runs one check and collects its error, so that the other checks still run.
  template <class Check>
  void guarded(const Check& check) {
    try {
      check();
    } catch (const Error& e) {
      errors_.push_back(e);
    }
  }

  void collect(const XMLElement& e) {
    const bool is_link = std::strcmp(e.Name(), "link") == 0;
    if (!is_link && std::strcmp(e.Name(), "joint") != 0) return;
    const std::string name = d_.text(e, "name");
    if (name.empty()) d_.fail(e, std::string("<") + e.Name() + "> has an empty name");
    if (name == "universe") d_.fail(e, std::string("a ") + e.Name() + " is called 'universe', which is reserved for the world; rename it");
    auto& known = is_link ? out_.link : out_.joint;
    if (const auto [first, is_new] = known.emplace(name, &e); !is_new)
      d_.fail(e, std::string("two ") + e.Name() + "s are called '" + name + "'; the other is at line " + std::to_string(first->second->GetLineNum()));
    (is_link ? out_.links : out_.joints).push_back(&e);
  }

  void tree() {
    if (out_.links.empty()) d_.fail(d_.robot(), "has no <link>");
    std::unordered_map<std::string, const XMLElement*> carrier;  // link -> the joint whose child it is
    for (const XMLElement* joint : out_.joints) {
      const std::string name = joint->Attribute("name"), parent = linkOf(d_, *joint, "parent"), child = linkOf(d_, *joint, "child");
      for (const std::string& link : {parent, child})
        if (!out_.link.count(link)) {
          d_.fail(*joint, "joint '" + name + "' names link '" + link + "', which does not exist" + near(link, out_.links));
        }
      if (parent == child) d_.fail(*joint, "joint '" + name + "' joins link '" + parent + "' to itself");
      if (const auto [first, is_new] = carrier.emplace(child, joint); !is_new)
        d_.fail(*joint, "link '" + child + "' has two parents: joints '" + first->second->Attribute("name") + "' and '" + name +
                            "'; URDF describes trees only");
      out_.joints_below[parent].push_back(joint);
    }
    for (const XMLElement* link : out_.links) {
      const std::string name = link->Attribute("name");
      if (carrier.count(name)) continue;
      if (!out_.root.empty()) d_.fail(*link, "links '" + out_.root + "' and '" + name + "' both have no parent; a robot has one root");
      out_.root = name;
    }
    if (out_.root.empty()) d_.fail(d_.robot(), "has no root link: its joints form a circle");
    std::vector<const std::string*> stack{&out_.root};
    std::unordered_set<std::string> reached{out_.root};
    while (!stack.empty()) {
      const auto below = out_.joints_below.find(*stack.back());
      stack.pop_back();
      if (below == out_.joints_below.end()) continue;
      for (const XMLElement* joint : below->second) stack.push_back(&*reached.insert(linkOf(d_, *joint, "child")).first);
    }
    for (const XMLElement* link : out_.links)
      if (!reached.count(link->Attribute("name")))
        d_.fail(*link, "link '" + std::string(link->Attribute("name")) + "' is not reached from the root '" + out_.root + "': joints form a circle");
  }

  void checkOrigin(const XMLElement& parent) const {
    if (const XMLElement* e = parent.FirstChildElement("origin")) poseOf(d_, *e);
  }

  void checkLink(const XMLElement& link) const {
    const XMLElement* inertial = link.FirstChildElement("inertial");
    if (inertial == nullptr) return;
    checkOrigin(*inertial);
    const std::string name = link.Attribute("name");
    const XMLElement* mass = inertial->FirstChildElement("mass");
    const XMLElement* inertia = inertial->FirstChildElement("inertia");
    if (mass == nullptr) d_.fail(*inertial, "link '" + name + "': <inertial> has no <mass>");
    if (inertia == nullptr) d_.fail(*inertial, "link '" + name + "': <inertial> has no <inertia>");
    const double m = d_.number(*mass, "value");
    if (m < 0) d_.fail(*mass, "link '" + name + "': its mass is negative");
    double xx = d_.number(*inertia, "ixx"), xy = d_.number(*inertia, "ixy", 0), xz = d_.number(*inertia, "ixz", 0);
    double yy = d_.number(*inertia, "iyy"), yz = d_.number(*inertia, "iyz", 0), zz = d_.number(*inertia, "izz");
    // The inertia must be positive semi-definite, which its principal minors tell. `slack` allows for the rounding of numbers written with a few
    // digits, and for rounding relative to the same body's inertia about the link's origin.
    note(*inertial, m == 0 && (xx != 0 || yy != 0 || zz != 0), "link '" + name + "': it has an inertia but no mass");
    note(*inertial, m > 0 && xx == 0 && yy == 0 && zz == 0, "link '" + name + "': it has a mass but no inertia, as a point has");
    const double scale = std::max({std::fabs(xx), std::fabs(yy), std::fabs(zz), std::fabs(xy), std::fabs(xz), std::fabs(yz)});
    const XMLElement* origin = inertial->FirstChildElement("origin");
    const Vec3<double> com = origin && origin->Attribute("xyz") ? d_.vector3(*origin, "xyz") : Vec3<double>{};
    if (scale == 0) return;
    // Scaled by the largest entry, so that no product of three entries leaves the range of doubles.
    for (double* moment : {&xx, &yy, &zz, &xy, &xz, &yz}) *moment /= scale;
    const double slack = 1e-6 + 1e-15 * m * dot(com, com) / scale;
    const double minors[] = {(xx + slack) * (yy + slack) - xy * xy, (xx + slack) * (zz + slack) - xz * xz, (yy + slack) * (zz + slack) - yz * yz};
    const double determinant =
        (xx + slack) * ((yy + slack) * (zz + slack) - yz * yz) - xy * (xy * (zz + slack) - yz * xz) + xz * (xy * yz - (yy + slack) * xz);
    if (xx < -slack || yy < -slack || zz < -slack || *std::min_element(minors, minors + 3) < 0 || determinant < 0)
      indefinite(*inertia, "link '" + name + "': its inertia is not positive semi-definite; no body has it");
    checkTriangle(*inertia, name, xx, yy, zz, xy, xz, yz, slack);
  }

  void note(const XMLElement& e, bool condition, const std::string& what) const {
    if (condition) d_.notes().push_back("line " + std::to_string(e.GetLineNum()) + ": " + what);
  }

  void indefinite(const XMLElement& e, const std::string& what) const {
    if (inertias_ == Inertias::physical) d_.fail(e, what + " (urdf::Inertias::any, --inertia any, loads it all the same)");
    note(e, true, what);
  }

  /// Principal moments of a body satisfy A + B >= C, so the largest is at most half the trace. Adds a note otherwise.
  void checkTriangle(const XMLElement& e, const std::string& name, double xx, double yy, double zz, double xy, double xz, double yz,
                     double slack) const {
    const double half = 0.5 * (xx + yy + zz) + slack;
    // Then half * 1 - I is positive semi-definite.
    const double a = half - xx, b = half - yy, c = half - zz;
    const double determinant = a * (b * c - yz * yz) - xy * (xy * c + yz * xz) - xz * (xy * yz + b * xz);
    note(e, a < 0 || b < 0 || c < 0 || a * b < xy * xy || a * c < xz * xz || b * c < yz * yz || determinant < 0,
         "link '" + name + "': its inertia violates the triangle inequality; no real body has it");
  }

  void checkJoint(const XMLElement& joint) const {
    const std::string name = joint.Attribute("name"), type = d_.text(joint, "type");
    if (std::find(std::begin(joint_types), std::end(joint_types), type) == std::end(joint_types))
      d_.fail(joint,
              "joint '" + name + "': unknown type '" + type +
                  "'; URDF has fixed, revolute, continuous, prismatic, planar, floating (in small letters), and <libdyn> names those of plugins");
    checkOrigin(joint);
    if (const XMLElement* axis = joint.FirstChildElement("axis")) {
      const Vec3<double> n = d_.vector3(*axis, "xyz");
      if (n.x == 0 && n.y == 0 && n.z == 0 && type != "fixed" && type != "floating")
        d_.fail(*axis, "joint '" + name + "': its axis is zero; give it a direction");
    }
    if (const XMLElement* limit = joint.FirstChildElement("limit")) {
      const double lower = d_.number(*limit, "lower", 0), upper = d_.number(*limit, "upper", 0);
      if (lower > upper && (type == "revolute" || type == "prismatic"))
        d_.fail(*limit, "joint '" + name + "': its lower limit is above its upper one");
      const bool bounded = type == "revolute" || type == "prismatic", given = limit->Attribute("lower") || limit->Attribute("upper");
      note(*limit, bounded && !given, "joint '" + name + "': its <limit> has neither lower nor upper, so that its range is zero");
      note(*limit, type == "continuous" && given, "joint '" + name + "' (continuous): lower and upper in its <limit> are ignored");
      for (const char* attribute : {"effort", "velocity"})
        note(*limit, d_.number(*limit, attribute, 0) < 0, "joint '" + name + "': its " + attribute + " limit is negative");
    } else if (type == "revolute" || type == "prismatic") {
      note(joint, true, "joint '" + name + "' (" + type + ") has no <limit>: taken as unlimited");
    }
    if (const XMLElement* dynamics = joint.FirstChildElement("dynamics"))
      for (const char* attribute : {"damping", "friction"})
        if (d_.number(*dynamics, attribute, 0) < 0) d_.fail(*dynamics, "joint '" + name + "': its " + attribute + " is negative");
  }

  void checkMimic(const XMLElement& joint) {
    const XMLElement* mimic = joint.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    const std::string name = joint.Attribute("name");
    for (const char* attribute : {"multiplier", "offset"}) d_.number(*mimic, attribute, 0);
    std::unordered_set<const XMLElement*> path;
    for (const XMLElement* at = mimic; at && followed_.insert(at).second;) {
      path.insert(at);
      const std::string master = d_.text(*at, "joint");
      const auto found = out_.joint.find(master);
      if (found == out_.joint.end()) d_.fail(*at, "mimics joint '" + master + "', which does not exist" + near(master, out_.joints));
      at = found->second->FirstChildElement("mimic");
      note(*mimic, at != nullptr && path.size() == 1, "joint '" + name + "' mimics '" + master + "', which mimics another joint itself");
      if (path.count(at)) d_.fail(*at, "joint '" + master + "' mimics itself through a circle of mimics");
    }
  }

  /// Suggests names of elements. Only the first errors have suggestions, because each costs a search of all names.
  std::string near(const std::string& name, const std::vector<const XMLElement*>& elements) const {
    constexpr std::size_t most_errors_with = 10;
    std::vector<std::string> names;
    if (errors_.size() < most_errors_with)
      for (const XMLElement* element : elements) names.emplace_back(element->Attribute("name"));
    return nearNames(name, names);
  }

  const Document& d_;
  Inertias inertias_;
  std::vector<Error>& errors_;
  Outline out_;
  std::unordered_set<const XMLElement*> followed_;  ///< mimics whose chain of masters was checked, to its end or to the first error
};

}  // namespace

std::string linkOf(const Document& document, const XMLElement& joint, const char* which) {
  const XMLElement* e = joint.FirstChildElement(which);
  if (e == nullptr) document.fail(joint, "joint '" + document.text(joint, "name") + "' has no <" + which + ">");
  return document.text(*e, "link");
}

Outline validate(const Document& document, Inertias inertias, std::vector<Error>& errors) { return Validator(document, inertias, errors).run(); }

}  // namespace dyn::urdf
