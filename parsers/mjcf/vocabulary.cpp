// SPDX-License-Identifier: BSD-2-Clause
#include "vocabulary.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

namespace dyn::mjcf {

namespace {

using Names = std::set<std::string, std::less<>>;

/// The words of a text.
Names words(const std::string& text) {
  std::istringstream in(text);
  Names out;
  for (std::string word; in >> word;) out.insert(word);
  return out;
}

struct Element {
  Element(const char* attributes, const char* appearance, const char* children = "", const char* skipped = "")
      : read(words(attributes)), silent(words(appearance)), below(words(children)), passed(words(skipped)) {}
  Names read;    ///< attributes that are read
  Names silent;  ///< attributes that need no note
  Names below;   ///< children that are read
  Names passed;  ///< children that need no note
};

/// Elements whose default values are kept as they are written.
const std::string devices = "tendon motor position velocity intvelocity damper cylinder muscle adhesion general";

/// The elements by name. Where a name means several things, "parent/name" comes first.
const std::map<std::string, Element, std::less<>>& vocabulary() {
  static const std::string turn = "quat axisangle xyaxes zaxis euler ";
  static const char* inside = "body frame replicate inertial joint freejoint geom site composite flexcomp attach";
  static const std::map<std::string, Element, std::less<>> all = {
      {"mujoco",
       {"model", "", "compiler option default asset worldbody contact equality keyframe tendon actuator sensor", "visual statistic size custom"}},
      {"compiler",
       {"angle coordinate eulerseq autolimits inertiafromgeom inertiagrouprange balanceinertia boundmass boundinertia meshdir assetdir "
        "settotalmass strippath discardvisual exactmeshinertia fusestatic",
        "texturedir usethread convexhull fitaabb saveinertial conflict", "", "lengthrange"}},
      {"option", {"gravity", "", "flag"}},
      {"flag", {"gravity", ""}},
      {"default", {"class", "", "default joint geom site mesh equality", ("material camera light " + devices).c_str()}},
      {"default/equality", {"solref active", ""}},
      {"asset", {"", "", "mesh", "texture material skin"}},
      {"mesh", {"name class file vertex face refpos refquat scale inertia", "normal texcoord smoothnormal material content_type"}},
      {"worldbody", {"", "", inside, "light"}},
      {"body", {(turn + "name childclass pos mocap").c_str(), "user sleep simple", inside, "light"}},
      {"frame", {(turn + "name childclass pos").c_str(), "", inside, "light"}},
      {"replicate", {"count offset euler sep childclass", "", inside, "light"}},
      {"inertial", {(turn + "pos mass diaginertia fullinertia").c_str(), ""}},
      {"joint", {"name class type pos axis ref range limited armature damping frictionloss actuatorfrcrange actuatorfrclimited", "group user"}},
      {"freejoint", {"name", "group"}},
      {"geom", {(turn + "name class type contype conaffinity group size mass density shellinertia fromto pos mesh").c_str(), "material rgba user"}},
      {"site", {(turn + "name class pos fromto").c_str(), "type size group material rgba user"}},
      {"contact", {"", "", "pair exclude"}},
      {"pair", {"name class geom1 geom2", ""}},
      {"exclude", {"name body1 body2", ""}},
      {"equality", {"", "", "connect weld joint tendon"}},
      {"connect", {"name class active solref body1 body2 site1 site2 anchor", ""}},
      {"weld", {"name class active solref body1 body2 site1 site2 relpose anchor", ""}},
      {"equality/joint", {"name class active solref joint1 joint2 polycoef", ""}},
      {"equality/tendon", {"name class active solref tendon1 tendon2 polycoef", ""}},
      {"tendon", {"", "", "fixed"}},
      {"fixed", {"name", "group user", "joint"}},
      {"fixed/joint", {"joint coef", ""}},
      {"actuator", {"", ""}},
      {"sensor", {"", ""}},
      {"keyframe", {"", "", "key"}},
      {"key", {"name qpos qvel", ""}}};
  return all;
}

const Element* elementOf(const char* parent, const char* name) {
  const auto& all = vocabulary();
  auto found = all.find(std::string(parent) + "/" + name);
  if (found == all.end()) found = all.find(std::string_view(name));
  return found == all.end() ? nullptr : &found->second;
}

class Scan {
 public:
  Scan(const Source& source, xml::Notes& notes) : s_(source), notes_(notes) {}

  void run() {
    struct Entry {
      const XMLElement* element;
      const Element* known;
    };
    std::vector<Entry> left{{&s_.root(), elementOf("", "mujoco")}};
    while (!left.empty()) {
      const auto [e, known] = left.back();
      left.pop_back();
      attributes(*e, *known);
      s_.forEach(*e, [&](const XMLElement& child) {
        if (known->passed.count(child.Name())) return;
        const Element* below = known->below.count(child.Name()) ? elementOf(e->Name(), child.Name()) : nullptr;
        if (below != nullptr) {
          left.push_back({&child, below});
        } else if (!refused(child.Name()) || !known->below.count(child.Name())) {
          count(std::string("<") + child.Name() + "> in <" + e->Name() + ">", child);
        }
      });
    }
  }

 private:
  /// Elements that the reader itself refuses.
  static bool refused(const std::string& name) { return name == "composite" || name == "flexcomp" || name == "attach"; }

  void attributes(const XMLElement& e, const Element& known) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next())
      if (!known.read.count(a->Name()) && !known.silent.count(a->Name()) && std::strncmp(a->Name(), "xmlns", 5) != 0)
        count(std::string("attribute ") + a->Name() + " of <" + e.Name() + ">", e);
  }
  void count(const std::string& what, const XMLElement& at) { notes_.count("ignored: " + what, s_.where(at)); }

  const Source& s_;
  xml::Notes& notes_;
};

}  // namespace

bool reads(const std::string& kind, const char* attribute) {
  const auto found = vocabulary().find(kind);
  return found != vocabulary().end() && found->second.read.count(attribute);
}

bool isDevice(const std::string& kind) {
  static const Names all = words(devices);
  return all.count(kind) > 0;
}

void noteUnread(const Source& source, xml::Notes& notes) { Scan(source, notes).run(); }

}  // namespace dyn::mjcf
