// SPDX-License-Identifier: BSD-2-Clause
#include "validate.hpp"

#include "common/inertia.hpp"
#include "extension.hpp"
#include "version.hpp"
#include "vocabulary.hpp"
#include "welded.hpp"

#include <dyn/near_names.hpp>

#include <algorithm>
#include <cstring>
#include <optional>
#include <unordered_set>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;

constexpr const char* joint_types[] = {"fixed", "revolute", "continuous", "prismatic", "planar", "floating"};

class Validator {
 public:
  Validator(const Document& document, const Options& options, std::vector<Error>& errors)
      : d_(document), inertias_(options.inertias), versions_(options.versions), errors_(errors) {}

  Outline run() {
    guarded([&] { checkVersion(d_, versions_); });
    for (const XMLElement* e = d_.robot().FirstChildElement(); e; e = e->NextSiblingElement()) guarded([&] { collect(*e); });
    guarded([&] { tree(); });
    for (const XMLElement* link : out_.links) guarded([&] { checkLink(*link); });
    for (const XMLElement* joint : out_.joints) guarded([&] { checkJoint(*joint); });
    for (const XMLElement* joint : out_.joints) guarded([&] { checkMimic(*joint); });
    guarded([&] { judgeIndefinite(); });
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

  void checkLink(const XMLElement& link) {
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
    const Sym3<double> I{d_.number(*inertia, "ixx"), d_.number(*inertia, "ixy", 0), d_.number(*inertia, "ixz", 0),
                         d_.number(*inertia, "iyy"), d_.number(*inertia, "iyz", 0), d_.number(*inertia, "izz")};
    const XMLElement* origin = inertial->FirstChildElement("origin");
    const Vec3<double> com = origin && origin->Attribute("xyz") ? d_.vector3(*origin, "xyz") : Vec3<double>{};
    const reader::InertiaFaults faults = reader::faultsOf({m, com, I});
    note(*inertial, faults.massless, "link '" + name + "': " + reader::massless_words);
    note(*inertial, faults.point, "link '" + name + "': " + reader::point_words);
    if (faults.indefinite) indefinite_.push_back({&link, inertia});
    note(*inertia, faults.unreal, "link '" + name + "': " + reader::unreal_words);
  }

  void note(const XMLElement& e, bool condition, const std::string& what) const {
    if (condition) d_.notes().push_back("line " + std::to_string(e.GetLineNum()) + ": " + what);
  }

  /// Refuses links whose inertia no body has, unless fixed joints weld them to others and the rigid body of all has one that is possible.
  void judgeIndefinite() {
    if (indefinite_.empty()) return;
    const std::optional<WeldedBodies> welded = errors_.empty() ? std::optional<WeldedBodies>(std::in_place, d_, out_) : std::nullopt;
    for (const auto& [link, inertia] : indefinite_) {
      const std::string name = link->Attribute("name");
      const int links = welded ? welded->links(name) : 1;
      std::string what = "link '" + name + "': " + reader::indefinite_words;
      if (links > 1 && welded->isPhysical(name)) {
        note(*inertia, true, what + ", but the rigid body of " + std::to_string(links) + " links to which it is fixed has one that is possible");
        continue;
      }
      if (links > 1) what += ", nor has the rigid body of " + std::to_string(links) + " links to which it is fixed";
      if (inertias_ == Inertias::any) {
        note(*inertia, true, what);
      } else {
        guarded([&, at = inertia] { d_.fail(*at, what + reader::anyway_words); });
      }
    }
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
      for (const char* attribute : {"effort", "velocity", "acceleration", "deceleration", "jerk"})
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

  struct Indefinite {
    const XMLElement *link, *inertia;
  };

  const Document& d_;
  Inertias inertias_;
  Versions versions_;
  std::vector<Error>& errors_;
  Outline out_;
  std::vector<Indefinite> indefinite_;              ///< links with inertias that no body has
  std::unordered_set<const XMLElement*> followed_;  ///< mimics whose chain of masters was checked, to its end or to the first error
};

}  // namespace

std::string linkOf(const Document& document, const XMLElement& joint, const char* which) {
  const XMLElement* e = joint.FirstChildElement(which);
  if (e == nullptr) document.fail(joint, "joint '" + document.text(joint, "name") + "' has no <" + which + ">");
  return document.text(*e, "link");
}

Outline validate(const Document& document, const Options& options, std::vector<Error>& errors) { return Validator(document, options, errors).run(); }

}  // namespace dyn::urdf
