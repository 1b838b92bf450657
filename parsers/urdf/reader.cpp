// SPDX-License-Identifier: BSD-2-Clause
#include "extension.hpp"
#include "geometry.hpp"
#include "welded.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <cstring>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;

class Reader {
 public:
  Reader(const Document& document, const Options& options, Outline outline)
      : d_(document), options_(options), outline_(std::move(outline)), extensions_(readExtensions(document, outline_)) {}

  Model run() {
    model_.name = d_.robot().Attribute("name") ? d_.robot().Attribute("name") : "robot";
    // Depth first with a stack of its own: a long chain must not overflow the call stack.
    struct Entry {
      const XMLElement* joint;
      int parent;
    };
    std::vector<Entry> stack;
    const auto pushBelow = [&](const std::string& link, int body) {
      const auto below = outline_.joints_below.find(link);
      if (below == outline_.joints_below.end()) return;
      std::vector<const XMLElement*> joints = below->second;
      if (options_.order == Order::name)
        std::sort(joints.begin(), joints.end(),
                  [](const XMLElement* a, const XMLElement* b) { return std::strcmp(a->Attribute("name"), b->Attribute("name")) < 0; });
      for (auto e = joints.rbegin(); e != joints.rend(); ++e) stack.push_back({*e, body});
    };
    pushBelow(outline_.root, addLink(outline_.root, 0, rootJoint()));
    while (!stack.empty()) {
      const Entry e = stack.back();
      stack.pop_back();
      const std::string link = linkOf(d_, *e.joint, "child");
      pushBelow(link, addLink(link, e.parent, joint(*e.joint)));
    }
    if (mimics_ > 0)
      d_.notes().push_back(std::to_string(mimics_) +
                           (options_.mimic == Mimic::coupled ? " mimic joints follow their masters" : " mimic joints move on their own"));
    if (limits_without_use_ > 0)
      d_.notes().push_back(std::to_string(limits_without_use_) + " fixed, floating or planar joints have a <limit> or <dynamics>, which is ignored");
    model_.constraints = readConstraints(d_, outline_);
    model_.notes = d_.notes();
    return std::move(model_);
  }

 private:
  int addLink(const std::string& name, int parent, JointDescription joint) {
    const XMLElement& link = *outline_.link.at(name);
    const int body = model_.addBody(name, parent, std::move(joint), inertiaOf(d_, link));
    model_.bodies.back().where = d_.where(link);
    for (GeometryDescription& g : readGeometries(d_, link, body)) model_.geometries.push_back(std::move(g));
    return body;
  }

  JointDescription rootJoint() const {
    JointDescription joint;
    joint.name = "root_joint";
    while (outline_.joint.count(joint.name)) joint.name += '_';
    if (joint.name != "root_joint")
      d_.notes().push_back("joint '" + joint.name + "' carries the root link, as the file has a 'root_joint' of its own");
    joint.type = options_.root;
    joint.where = {d_.file(), 0, joint.name};
    return joint;
  }

  SE3<double> origin(const XMLElement& parent) const {
    const XMLElement* e = parent.FirstChildElement("origin");
    return e ? poseOf(d_, *e) : SE3<double>{};
  }

  JointDescription joint(const XMLElement& e) {
    JointDescription j;
    j.name = e.Attribute("name");
    j.where = d_.where(e, j.name);
    j.placement = origin(e);
    const std::string type = e.Attribute("type");
    j.type = type == "floating" ? "free_flyer" : type;
    if (type == "continuous" && options_.continuous == Continuous::angle) j.type = "revolute";
    if (type != "fixed" && type != "floating") {
      const XMLElement* axis = e.FirstChildElement("axis");
      const Vec3<double> n = axis ? d_.vector3(*axis, "xyz") : Vec3<double>{1, 0, 0};
      j.parameters["axis"] = std::vector<double>{n.x, n.y, n.z};
    }
    readLimits(e, type, j);
    readMimic(e, j);
    if (const auto extension = extensions_.find(j.name); extension != extensions_.end()) applyExtension(d_, *extension->second, j);
    return j;
  }

  void readLimits(const XMLElement& e, const std::string& type, JointDescription& j) {
    if (type == "fixed" || type == "floating" || type == "planar") {
      limits_without_use_ += e.FirstChildElement("limit") || e.FirstChildElement("dynamics") ? 1 : 0;
      return;
    }
    if (const XMLElement* limit = e.FirstChildElement("limit")) {
      if (type == "revolute" || type == "prismatic") {
        j.limits.lower = {d_.number(*limit, "lower", 0)};
        j.limits.upper = {d_.number(*limit, "upper", 0)};
      }
      const auto read = [&](const char* attribute, std::vector<double>& values) {
        if (limit->Attribute(attribute)) values = {d_.number(*limit, attribute)};
      };
      read("effort", j.limits.effort);
      read("velocity", j.limits.velocity);
      read("acceleration", j.limits.acceleration);
      read("deceleration", j.limits.deceleration);
      read("jerk", j.limits.jerk);
    }
    if (const XMLElement* dynamics = e.FirstChildElement("dynamics")) {
      if (dynamics->Attribute("damping")) j.damping = {d_.number(*dynamics, "damping")};
      if (dynamics->Attribute("friction")) j.friction = {d_.number(*dynamics, "friction")};
    }
  }

  void readMimic(const XMLElement& e, JointDescription& j) {
    const XMLElement* mimic = e.FirstChildElement("mimic");
    if (mimic == nullptr) return;
    ++mimics_;
    if (options_.mimic == Mimic::independent) return;
    j.coupling.type = "mimic";
    j.coupling.master = d_.text(*mimic, "joint");
    j.coupling.parameters["coefficients"] = std::vector<double>{d_.number(*mimic, "offset", 0), d_.number(*mimic, "multiplier", 1)};
  }

  const Document& d_;
  const Options& options_;
  Outline outline_;
  Extensions extensions_;
  Model model_;
  int mimics_ = 0;
  int limits_without_use_ = 0;
};

}  // namespace

Model parse(const std::string& text, const std::string& name, const Options& options) {
  const Document document(text, name);
  std::vector<Error> errors;
  Outline outline = validate(document, options, errors);
  if (!errors.empty()) throw errors.front();
  return Reader(document, options, std::move(outline)).run();
}

Model load(const std::string& path, const Options& options) { return parse(readFile(path, largest_file), path, options); }

std::vector<Error> check(const std::string& path, const Options& options) {
  std::vector<Error> errors;
  try {
    const Document document(readFile(path, largest_file), path);
    Outline outline = validate(document, options, errors);
    if (errors.empty()) Reader(document, options, std::move(outline)).run();
  } catch (const Error& e) {
    errors.push_back(e);
  }
  return errors;
}

}  // namespace dyn::urdf
