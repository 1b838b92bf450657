// Robots from URDF: links, joints, inertias, limits, losses, mimic.
#include <dyn/parsers/urdf.hpp>

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <unordered_map>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;

class Reader {
 public:
  Reader(std::string name, const Options& options) : file_(std::move(name)), options_(options) {}

  Model read(const std::string& text) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      throw Error(ErrorCode::syntax, std::string("is not XML: ") + document.ErrorStr(), {file_, document.ErrorLineNum(), ""});
    const XMLElement* robot = document.RootElement();
    if (robot == nullptr || std::strcmp(robot->Name(), "robot") != 0) throw Error(ErrorCode::syntax, "has no element <robot>", {file_, 1, ""});
    model_.name = robot->Attribute("name") ? robot->Attribute("name") : "robot";
    for (const XMLElement* e = robot->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
      if (!links_.emplace(text_(e, "name"), e).second) fail(e, "two links are called '" + text_(e, "name") + "'");
      link_order_.push_back(e);
    }
    std::unordered_map<std::string, int> names;
    for (const XMLElement* e = robot->FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
      if (!names.emplace(text_(e, "name"), 1).second) fail(e, "two joints are called '" + text_(e, "name") + "'");
      const std::string parent = linkOf(e, "parent"), child = linkOf(e, "child");
      children_[parent].push_back(e);
      if (!parent_of_.emplace(child, parent).second) fail(e, "link '" + child + "' is the child of two joints");
    }
    if (options_.order == Order::name)
      for (auto& [parent, joints] : children_)
        std::sort(joints.begin(), joints.end(), [](const XMLElement* a, const XMLElement* b) { return std::strcmp(a->Attribute("name"), b->Attribute("name")) < 0; });
    build();
    return std::move(model_);
  }

 private:
  [[noreturn]] void fail(const XMLElement* e, const std::string& why) const { throw Error(ErrorCode::model, why, {file_, e->GetLineNum(), ""}); }

  std::string text_(const XMLElement* e, const char* attribute) const {
    const char* value = e->Attribute(attribute);
    if (value == nullptr) fail(e, std::string("<") + e->Name() + "> has no attribute '" + attribute + "'");
    return value;
  }
  std::string linkOf(const XMLElement* joint, const char* which) const {
    const XMLElement* e = joint->FirstChildElement(which);
    if (e == nullptr) fail(joint, "joint '" + text_(joint, "name") + "' has no <" + which + ">");
    const std::string link = text_(e, "link");
    if (!links_.count(link)) fail(e, "joint '" + text_(joint, "name") + "' names link '" + link + "', which does not exist");
    return link;
  }

  std::vector<double> numbers(const XMLElement* e, const char* attribute) const {
    const std::string text = text_(e, attribute);
    std::vector<double> out;
    const char* p = text.data();
    const char* end = p + text.size();
    while (true) {
      while (p != end && std::isspace(static_cast<unsigned char>(*p))) ++p;
      if (p == end) return out;
      if (*p == '+') ++p;
      double x = 0;
      const auto [next, error] = std::from_chars(p, end, x);
      if (error != std::errc() || !std::isfinite(x) || (next != end && !std::isspace(static_cast<unsigned char>(*next))))
        fail(e, std::string("<") + e->Name() + "> " + attribute + "=\"" + text + "\" is not made of finite numbers");
      out.push_back(x);
      p = next;
    }
  }
  double number(const XMLElement* e, const char* attribute) const {
    const std::vector<double> x = numbers(e, attribute);
    if (x.size() != 1) fail(e, std::string("<") + e->Name() + "> " + attribute + " must be one number");
    return x[0];
  }
  Vec3<double> vector3(const XMLElement* e, const char* attribute) const {
    const std::vector<double> x = numbers(e, attribute);
    if (x.size() != 3) fail(e, std::string("<") + e->Name() + "> " + attribute + " must be three numbers, it has " + std::to_string(x.size()));
    return {x[0], x[1], x[2]};
  }

  SE3<double> origin(const XMLElement* parent) const {
    const XMLElement* e = parent->FirstChildElement("origin");
    SE3<double> X;
    if (e == nullptr) return X;
    if (e->Attribute("xyz")) X.p = vector3(e, "xyz");
    if (e->Attribute("rpy")) {
      const Vec3<double> a = vector3(e, "rpy");
      const long double cr = std::cos(static_cast<long double>(a.x)), sr = std::sin(static_cast<long double>(a.x));
      const long double cp = std::cos(static_cast<long double>(a.y)), sp = std::sin(static_cast<long double>(a.y));
      const long double cy = std::cos(static_cast<long double>(a.z)), sy = std::sin(static_cast<long double>(a.z));
      const long double R[9] = {cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr,
                                sy * sp * cr - cy * sr, -sp, cp * sr, cp * cr};
      for (int i = 0; i < 9; ++i) X.R.m[i] = static_cast<double>(R[i]);
    }
    return X;
  }

  Inertia<double> inertia(const XMLElement* link) const {
    Inertia<double> Y;
    const XMLElement* e = link->FirstChildElement("inertial");
    if (e == nullptr) return Y;
    const SE3<double> X = origin(e);
    if (const XMLElement* m = e->FirstChildElement("mass")) Y.mass = number(m, "value");
    if (Y.mass < 0) fail(e, "link '" + text_(link, "name") + "': its mass is negative");
    if (const XMLElement* i = e->FirstChildElement("inertia"))
      Y.rotational = {number(i, "ixx"), number(i, "ixy"), number(i, "ixz"), number(i, "iyy"), number(i, "iyz"), number(i, "izz")};
    return Y.transformed(X);
  }

  JointDescription joint(const XMLElement* e) {
    JointDescription j;
    j.name = text_(e, "name");
    j.where = {file_, e->GetLineNum(), j.name};
    j.placement = origin(e);
    const std::string type = text_(e, "type");
    std::vector<double> axis{1, 0, 0};
    if (const XMLElement* a = e->FirstChildElement("axis")) {
      const Vec3<double> n = vector3(a, "xyz");
      axis = {n.x, n.y, n.z};
    }
    if (type == "revolute" || type == "prismatic" || type == "planar" || type == "fixed") {
      j.type = type;
    } else if (type == "continuous") {
      j.type = options_.continuous == Continuous::angle ? "revolute" : "continuous";
    } else if (type == "floating") {
      j.type = "free_flyer";
    } else {
      fail(e, "joint '" + j.name + "': unknown type '" + type + "'; URDF has fixed, revolute, continuous, prismatic, planar, floating");
    }
    if (type != "fixed" && type != "floating") j.parameters["axis"] = axis;
    const XMLElement* limit = e->FirstChildElement("limit");
    if (limit && (type == "revolute" || type == "prismatic")) {
      j.limits.lower = {limit->Attribute("lower") ? number(limit, "lower") : 0.0};
      j.limits.upper = {limit->Attribute("upper") ? number(limit, "upper") : 0.0};
      if (j.limits.lower[0] > j.limits.upper[0]) fail(limit, "joint '" + j.name + "': its lower limit is above the upper one");
    }
    if (limit && limit->Attribute("effort")) j.limits.effort = {number(limit, "effort")};
    if (limit && limit->Attribute("velocity")) j.limits.velocity = {number(limit, "velocity")};
    if (const XMLElement* d = e->FirstChildElement("dynamics")) {
      if (d->Attribute("damping")) j.damping = {number(d, "damping")};
      if (d->Attribute("friction")) j.friction = {number(d, "friction")};
    }
    if (const XMLElement* m = e->FirstChildElement("mimic")) {
      if (options_.mimic == Mimic::coupled) {
        j.coupling.type = "mimic";
        j.coupling.master = text_(m, "joint");
        j.coupling.parameters["coefficients"] =
            std::vector<double>{m->Attribute("offset") ? number(m, "offset") : 0.0, m->Attribute("multiplier") ? number(m, "multiplier") : 1.0};
      } else {
        model_.notes.push_back("joint '" + j.name + "' mimics '" + text_(m, "joint") + "' in the file; it moves on its own here");
      }
    }
    return j;
  }

  void build() {
    const XMLElement* root = nullptr;
    for (const XMLElement* link : link_order_) {
      if (parent_of_.count(link->Attribute("name"))) continue;
      if (root) fail(link, "two links have no parent: '" + text_(root, "name") + "' and '" + text_(link, "name") + "'");
      root = link;
    }
    if (root == nullptr) throw Error(ErrorCode::model, link_order_.empty() ? "has no links" : "has no root: its joints form a circle", {file_, 1, ""});
    JointDescription root_joint;
    root_joint.name = "root_joint";
    root_joint.type = options_.root;
    root_joint.where = {file_, root->GetLineNum(), "root_joint"};
    struct Entry {
      const XMLElement* joint;
      int parent;
    };
    std::vector<Entry> stack;
    const auto push = [&](const std::string& link, int body) {
      const auto found = children_.find(link);
      if (found == children_.end()) return;
      for (auto e = found->second.rbegin(); e != found->second.rend(); ++e) stack.push_back({*e, body});
    };
    push(text_(root, "name"), model_.addBody(text_(root, "name"), 0, root_joint, inertia(root)));
    std::size_t reached = 1;
    while (!stack.empty()) {
      const Entry e = stack.back();
      stack.pop_back();
      const std::string link = linkOf(e.joint, "child");
      push(link, model_.addBody(link, e.parent, joint(e.joint), inertia(links_.at(link))));
      ++reached;
    }
    if (reached < link_order_.size()) throw Error(ErrorCode::model, "some links are not reached from the root: their joints form a circle", {file_, 1, ""});
  }

  std::string file_;
  const Options& options_;
  Model model_;
  std::vector<const XMLElement*> link_order_;
  std::unordered_map<std::string, const XMLElement*> links_;
  std::unordered_map<std::string, std::vector<const XMLElement*>> children_;
  std::unordered_map<std::string, std::string> parent_of_;
};

}  // namespace

Model parse(const std::string& text, const std::string& name, const Options& options) { return Reader(name, options).read(text); }

Model load(const std::string& path, const Options& options) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) throw Error(ErrorCode::file, "is not a file that can be read", {path, 0, ""});
  if (std::filesystem::file_size(path) > (64u << 20)) throw Error(ErrorCode::file, "is larger than 64 MB; no URDF is", {path, 0, ""});
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw Error(ErrorCode::file, "cannot be read", {path, 0, ""});
  return parse(text.str(), path, options);
}

}  // namespace dyn::urdf
