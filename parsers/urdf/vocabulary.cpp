// SPDX-License-Identifier: BSD-2-Clause
#include "vocabulary.hpp"

#include "xml/notes.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;
bool has(const Names& names, const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); }

class Scan {
 public:
  Scan(const Document& document, const Vocabulary& words) : d_(document), words_(words) {}

  void run() {
    // A stack instead of recursion. Unknown elements may be nested to any depth, but they are not entered.
    std::vector<const XMLElement*> left{&d_.robot()};
    while (!left.empty()) {
      const XMLElement& e = *left.back();
      left.pop_back();
      const ElementWords& known = *wordsOf(e);
      attributes(e, known);
      Names seen;
      for (const XMLElement* child = e.FirstChildElement(); child; child = child->NextSiblingElement()) {
        const bool once = has(known.once, child->Name());
        if (!once && !has(known.any, child->Name())) {
          // readGeometries() notes an unknown shape, with the volume that is left out.
          if (std::strcmp(e.Name(), "geometry") != 0) count(std::string("<") + child->Name() + "> in <" + e.Name() + ">", *child);
        } else if (once && has(seen, child->Name())) {
          count(std::string("<") + child->Name() + "> in <" + e.Name() + "> after the first", *child);
        } else {
          seen.emplace_back(child->Name());
          if (wordsOf(*child)) left.push_back(child);
        }
      }
    }
    for (std::string& note : unread_.lines(d_.file())) d_.notes().push_back(std::move(note));
  }

 private:
  const ElementWords* wordsOf(const XMLElement& e) const {
    const XMLElement* parent = e.Parent()->ToElement();
    auto found = parent ? words_.find(std::string(parent->Name()) + "/" + e.Name()) : words_.end();
    if (found == words_.end()) found = words_.find(e.Name());
    return found == words_.end() ? nullptr : &found->second;
  }
  void attributes(const XMLElement& e, const ElementWords& known) {
    for (const tinyxml2::XMLAttribute* a = e.FirstAttribute(); a; a = a->Next())
      if (!has(known.attributes, a->Name()) && std::strncmp(a->Name(), "xmlns", 5) != 0)
        count(std::string("attribute ") + a->Name() + " of <" + e.Name() + ">", e);
  }
  void count(const std::string& what, const XMLElement& at) { unread_.count("ignored: " + what, d_.where(at)); }

  const Document& d_;
  const Vocabulary& words_;
  xml::Notes unread_;
};

}  // namespace

const Vocabulary& vocabulary() {
  const ElementWords origin{{"xyz", "rpy", "quat_xyzw"}, {}, {}};
  static const Vocabulary all = {{"robot", {{"name", "version"}, {}, {"link", "joint", "libdyn"}}},
                                 {"link", {{"name"}, {"inertial"}, {"collision", "visual", "collision_checking"}}},
                                 {"inertial", {{}, {"origin", "mass", "inertia"}, {}}},
                                 {"origin", origin},
                                 {"mass", {{"value"}, {}, {}}},
                                 {"inertia", {{"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, {}, {}}},
                                 {"collision", {{"name"}, {"origin", "geometry"}, {}}},
                                 {"geometry", {{}, {"box", "sphere", "cylinder", "mesh", "capsule", "cone", "plane", "octree"}, {}}},
                                 {"box", {{"size"}, {}, {}}},
                                 {"sphere", {{"radius"}, {}, {}}},
                                 {"cylinder", {{"radius", "length"}, {}, {}}},
                                 {"capsule", {{"radius", "length"}, {}, {}}},
                                 {"cone", {{"radius", "length"}, {}, {}}},
                                 {"plane", {{"normal", "offset"}, {}, {}}},
                                 {"mesh", {{"filename", "scale"}, {}, {}}},
                                 {"octree", {{"filename"}, {}, {}}},
                                 {"joint", {{"name", "type"}, {"origin", "parent", "child", "axis", "limit", "dynamics", "mimic"}, {}}},
                                 {"parent", {{"link"}, {}, {}}},
                                 {"child", {{"link"}, {}, {}}},
                                 {"axis", {{"xyz"}, {}, {}}},
                                 {"limit", {{"lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"}, {}, {}}},
                                 {"dynamics", {{"damping", "friction"}, {}, {}}},
                                 {"mimic", {{"joint", "multiplier", "offset"}, {}, {}}}};
  return all;
}

void noteUnread(const Document& document, const Vocabulary& words) { Scan(document, words).run(); }

}  // namespace dyn::urdf
