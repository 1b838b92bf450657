// SPDX-License-Identifier: BSD-2-Clause
#include "urdf/document.hpp"
#include "urdf/vocabulary.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>
#include <dyn/parsers/srdf.hpp>

#include <cmath>
#include <unordered_map>
#include <unordered_set>

namespace dyn::srdf {

namespace {

using tinyxml2::XMLElement;

const urdf::Vocabulary& words() {
  static const urdf::Vocabulary all = {
      {"robot", {{"name", "version"}, {}, {"group", "group_state", "end_effector", "virtual_joint", "passive_joint", "disable_collisions"}}},
      {"group", {{"name"}, {}, {"link", "joint", "chain", "group"}}},
      {"group/group", {{"name"}, {}, {}}},
      {"group/joint", {{"name"}, {}, {}}},
      {"link", {{"name"}, {}, {}}},
      {"chain", {{"base_link", "tip_link"}, {}, {}}},
      {"group_state", {{"name", "group"}, {}, {"joint"}}},
      {"group_state/joint", {{"name", "value"}, {}, {}}},
      {"end_effector", {{"name", "group", "parent_link", "parent_group"}, {}, {}}},
      {"virtual_joint", {{"name", "type", "parent_frame", "child_link"}, {}, {}}},
      {"passive_joint", {{"name"}, {}, {}}},
      {"disable_collisions", {{"link1", "link2", "reason"}, {}, {}}}};
  return all;
}

/// Names of one kind in the model or in the file.
struct Names {
  const char* kind;
  std::unordered_map<std::string, int> index{};
  std::vector<std::string> list{};
  void add(const std::string& name, int i) {
    if (index.emplace(name, i).second) list.push_back(name);
  }
};

class Reader {
 public:
  Reader(const urdf::Document& document, const Model& model) : d_(document), model_(model) {
    for (std::size_t i = 1; i < model.bodies.size(); ++i) {
      links_.add(model.bodies[i].name, static_cast<int>(i));
      joints_.add(model.bodies[i].joint.name, static_cast<int>(i));
    }
    for (const GroupDescription& group : model.groups) groups_.add(group.name, -1);
  }

  /// Reads the file into `out`, which has nothing but what the file says.
  void run(Model& out) {
    urdf::noteUnread(d_, words());
    each("group", [&](const XMLElement& e) {
      const std::string name = d_.text(e, "name");
      if (groups_.index.count(name)) d_.fail(e, "two groups are called '" + name + "'; rename one");
      groups_.add(name, -1);
    });
    each("virtual_joint", [&](const XMLElement& e) { out.virtual_joints.push_back(virtualJoint(e)); });
    each("group", [&](const XMLElement& e) { out.groups.push_back(group(e)); });
    each("end_effector", [&](const XMLElement& e) { out.end_effectors.push_back(endEffector(e)); });
    each("passive_joint", [&](const XMLElement& e) { addKnown(out.passive_joints, e, "name", joints_); });
    each("group_state", [&](const XMLElement& e) { out.configurations.push_back(state(e)); });
    each("disable_collisions", [&](const XMLElement& e) {
      DisabledCollision d{d_.text(e, "link1"), d_.text(e, "link2"), e.Attribute("reason") ? e.Attribute("reason") : ""};
      known(e, d.body, links_);
      known(e, d.other, links_);
      out.disabled_collisions.push_back(std::move(d));
    });
    out.notes = d_.notes();
    for (std::string& text : out.notes) text = d_.file() + ": " + text;
    out.notes.insert(out.notes.end(), notes_.begin(), notes_.end());
  }

 private:
  template <class Each>
  void each(const char* tag, const Each& one) const {
    eachOf(d_.robot(), tag, one);
  }
  template <class Each>
  static void eachOf(const XMLElement& parent, const char* tag, const Each& one) {
    for (const XMLElement* e = parent.FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) one(*e);
  }

  void note(const XMLElement& e, const std::string& what) { notes_.push_back(d_.file() + ":" + std::to_string(e.GetLineNum()) + ": " + what); }

  /// Whether there is such a name. Adds a note otherwise.
  bool known(const XMLElement& e, const std::string& name, const Names& names) {
    if (names.index.count(name)) return true;
    // Only the first notes have suggestions, because each costs a search of all names.
    note(e, std::string("there is no ") + names.kind + " '" + name + "'" + (notes_.size() < 10 ? nearNames(name, names.list) : ""));
    return false;
  }

  void addKnown(std::vector<std::string>& out, const XMLElement& e, const char* attribute, const Names& names) {
    const std::string name = d_.text(e, attribute);
    if (known(e, name, names)) out.push_back(name);
  }

  GroupDescription group(const XMLElement& e) {
    GroupDescription out;
    out.name = d_.text(e, "name");
    out.where = d_.where(e);
    eachOf(e, "link", [&](const XMLElement& x) { addKnown(out.bodies, x, "name", links_); });
    eachOf(e, "joint", [&](const XMLElement& x) {
      const std::string name = d_.text(x, "name");
      if (const auto root = roots_.find(name); root != roots_.end()) {
        out.joints.push_back(root->second);
      } else if (known(x, name, joints_)) {
        out.joints.push_back(name);
      }
    });
    eachOf(e, "chain", [&](const XMLElement& x) {
      const Chain chain{d_.text(x, "base_link"), d_.text(x, "tip_link")};
      if (!known(x, chain.base, links_) || !known(x, chain.tip, links_)) return;
      const int base = links_.index.at(chain.base);
      int body = links_.index.at(chain.tip), below = body + 1;
      // Parents come first; a description that breaks this rule is refused by compile().
      while (body > base && body < below) {
        below = body;
        body = model_.bodies[static_cast<std::size_t>(body)].parent;
      }
      if (body == base) {
        out.chains.push_back(chain);
      } else {
        note(x, "link '" + chain.base + "' does not carry '" + chain.tip + "'; the chain is left out");
      }
    });
    eachOf(e, "group", [&](const XMLElement& x) { addKnown(out.groups, x, "name", groups_); });
    return out;
  }

  EndEffectorDescription endEffector(const XMLElement& e) {
    EndEffectorDescription out{d_.text(e, "name"), d_.text(e, "group"), d_.text(e, "parent_link"), {}, d_.where(e)};
    known(e, out.group, groups_);
    known(e, out.body, links_);
    if (e.Attribute("parent_group") && known(e, e.Attribute("parent_group"), groups_)) out.parent_group = e.Attribute("parent_group");
    return out;
  }

  VirtualJointDescription virtualJoint(const XMLElement& e) {
    const std::string type = d_.text(e, "type");
    if (type != "fixed" && type != "floating" && type != "planar")
      d_.fail(e, "virtual joint '" + d_.text(e, "name") + "': unknown type '" + type + "'; SRDF has fixed, floating and planar");
    VirtualJointDescription out{d_.text(e, "name"), type == "floating" ? "free_flyer" : type, d_.text(e, "parent_frame"), d_.text(e, "child_link"),
                                d_.where(e)};
    if (!known(e, out.body, links_)) return out;
    const BodyDescription& body = model_.bodies[static_cast<std::size_t>(links_.index.at(out.body))];
    if (body.parent != 0) {
      note(e, "virtual joint '" + out.name + "' carries link '" + out.body + "', which is not a root of the model");
    } else if (body.joint.type != out.type) {
      note(e, "virtual joint '" + out.name + "' is of type " + out.type + ", and the model's root joint '" + body.joint.name + "' of type " +
                  body.joint.type + "; --root " + out.type + " (the option root of load) makes them equal");
    } else {
      roots_.emplace(out.name, body.joint.name);
    }
    virtual_.insert(out.name);
    return out;
  }

  ConfigurationDescription state(const XMLElement& e) {
    ConfigurationDescription out;
    out.name = d_.text(e, "name");
    out.group = d_.text(e, "group");
    out.where = d_.where(e);
    known(e, out.group, groups_);
    std::unordered_set<std::string> seen;
    eachOf(e, "joint", [&](const XMLElement& x) {
      const std::string name = d_.text(x, "name");
      const std::vector<double> value = d_.numbers(x, "value");
      if (!seen.insert(name).second) d_.fail(x, "state '" + out.name + "' sets joint '" + name + "' twice");
      const auto root = roots_.find(name);
      if (root == roots_.end() && virtual_.count(name)) return;  // a note has said that the model has no such joint
      if (root == roots_.end() && !known(x, name, joints_)) return;
      const std::string& joint = root == roots_.end() ? name : root->second;
      const std::string& type = model_.bodies[static_cast<std::size_t>(joints_.index.at(joint))].joint.type;
      if (type == "fixed") {
        note(x, "state '" + out.name + "' sets joint '" + name + "', which is fixed; the value is left out");
        return;
      }
      if (value.empty()) d_.fail(x, "state '" + out.name + "' has no number for joint '" + name + "'", ErrorCode::syntax);
      out.joints.push_back({joint, coordinates(type, value), {}});
    });
    return out;
  }

  /// SRDF has one angle where the types of libdyn have its cosine and sine.
  static std::vector<double> coordinates(const std::string& type, std::vector<double> value) {
    const std::size_t angle = type == "continuous" ? 0 : type == "planar" ? 2 : value.size();
    if (angle + 1 != value.size()) return value;
    const double x = value.back();
    value.back() = std::cos(x);
    value.push_back(std::sin(x));
    return value;
  }

  const urdf::Document& d_;
  const Model& model_;
  Names links_{"link"}, joints_{"joint"}, groups_{"group"};
  std::unordered_map<std::string, std::string> roots_;  ///< virtual joint -> the root joint that it stands for
  std::unordered_set<std::string> virtual_;             ///< names of virtual joints
  std::vector<std::string> notes_;
};

template <class T>
void moveTo(std::vector<T>& out, std::vector<T>& from) {
  out.insert(out.end(), std::make_move_iterator(from.begin()), std::make_move_iterator(from.end()));
}

}  // namespace

void parse(const std::string& text, const std::string& name, Model& model) {
  const urdf::Document document(text, name);
  Model read;
  Reader(document, model).run(read);
  moveTo(model.groups, read.groups);
  moveTo(model.end_effectors, read.end_effectors);
  moveTo(model.virtual_joints, read.virtual_joints);
  moveTo(model.passive_joints, read.passive_joints);
  moveTo(model.configurations, read.configurations);
  moveTo(model.disabled_collisions, read.disabled_collisions);
  moveTo(model.notes, read.notes);
}

void load(const std::string& path, Model& model) { parse(readFile(path, urdf::largest_file), path, model); }

}  // namespace dyn::srdf
