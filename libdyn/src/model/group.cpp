// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"

#include <dyn/model/model.hpp>
#include <dyn/near_names.hpp>

#include <unordered_map>

namespace dyn {

namespace {

/// Collects the joints of groups.
class Members {
 public:
  explicit Members(const Model& model) : model_(model), member_(model.bodies.size(), false) {
    for (std::size_t i = 0; i < model.bodies.size(); ++i) {
      body_.emplace(model.bodies[i].name, i);
      if (i > 0) joint_.emplace(model.bodies[i].joint.name, i);
    }
    for (std::size_t k = 0; k < model.groups.size(); ++k) group_.emplace(model.groups[k].name, k);
  }

  std::vector<std::string> of(const std::string& name) {
    const auto first = group_.find(name);
    if (first == group_.end())
      throw Error(ErrorCode::argument, "the model '" + model_.name + "' has no group '" + name + "'" + nearNames(name, namesOf(model_.groups)));
    std::vector<bool> seen(model_.groups.size(), false);
    std::vector<std::size_t> open{first->second};
    seen[first->second] = true;
    while (!open.empty()) {
      const GroupDescription& group = model_.groups[open.back()];
      open.pop_back();
      for (const std::string& body : group.bodies) member_[find(body_, body, group, "body")] = true;
      for (const std::string& joint : group.joints) member_[find(joint_, joint, group, "joint")] = true;
      for (const Chain& chain : group.chains) add(chain, group);
      for (const std::string& sub : group.groups) {
        const std::size_t k = find(group_, sub, group, "group");
        if (!seen[k]) open.push_back(k);
        seen[k] = true;
      }
    }
    std::vector<std::string> joints;
    for (std::size_t i = 1; i < member_.size(); ++i)
      if (member_[i]) joints.push_back(model_.bodies[i].joint.name);
    return joints;
  }

 private:
  using Index = std::unordered_map<std::string, std::size_t>;

  static std::size_t find(const Index& index, const std::string& name, const GroupDescription& group, const char* what) {
    const auto found = index.find(name);
    if (found == index.end())
      throw Error(ErrorCode::model, "group '" + group.name + "' has the " + what + " '" + name + "', which does not exist", group.where);
    return found->second;
  }

  void add(const Chain& chain, const GroupDescription& group) {
    const std::size_t base = find(body_, chain.base, group, "body");
    std::size_t body = find(body_, chain.tip, group, "body");
    // Parents come first, so that a body before the base is not carried by it.
    while (body > base) {
      member_[body] = true;
      const int parent = model_.bodies[body].parent;
      if (parent < 0 || at(parent) >= body)
        throw Error(ErrorCode::model, "body '" + model_.bodies[body].name + "': its parent must come before it in Model::bodies", group.where);
      body = at(parent);
    }
    if (body != base)
      throw Error(ErrorCode::model,
                  "group '" + group.name + "' has a chain from '" + chain.base + "' to '" + chain.tip + "', which it does not carry", group.where);
  }

  const Model& model_;
  Index body_, joint_, group_;
  std::vector<bool> member_;  ///< by body: whether its joint belongs to the group
};

}  // namespace

std::vector<std::string> Model::jointsOf(const std::string& group) const { return Members(*this).of(group); }

}  // namespace dyn
