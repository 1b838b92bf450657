// SPDX-License-Identifier: BSD-2-Clause
#include "json/value.hpp"

#include <algorithm>

namespace dyn::json {

namespace {

void read(const Value& x, const char* key, std::vector<std::string>& out) {
  if (x.has(key)) x[key].each([&](const Value& name) { out.push_back(name.text()); });
}

GroupDescription groupOf(const Value& x) {
  x.only({"name", "bodies", "joints", "chains", "groups", "where"});
  GroupDescription out;
  out.name = x["name"].text();
  read(x, "bodies", out.bodies);
  read(x, "joints", out.joints);
  read(x, "groups", out.groups);
  if (x.has("chains"))
    x["chains"].each([&](const Value& chain) {
      chain.only({"base", "tip"});
      out.chains.push_back({chain["base"].text(), chain["tip"].text()});
    });
  out.where = whereOf(x);
  return out;
}

EndEffectorDescription endEffectorOf(const Value& x) {
  x.only({"name", "group", "body", "parent_group", "where"});
  EndEffectorDescription out{x["name"].text(), x["group"].text(), x["body"].text(), {}, whereOf(x)};
  json::read(x, "parent_group", out.parent_group);
  return out;
}

VirtualJointDescription virtualJointOf(const Value& x) {
  x.only({"name", "type", "frame", "body", "where"});
  return {x["name"].text(), x["type"].text(), x["frame"].text(), x["body"].text(), whereOf(x)};
}

ConfigurationDescription configurationOf(const Value& x) {
  x.only({"name", "group", "joints", "where"});
  ConfigurationDescription out;
  out.name = x["name"].text();
  json::read(x, "group", out.group);
  x["joints"].each([&](const Value& joint) {
    joint.only({"joint", "q", "v"});
    JointState state;
    state.joint = joint["joint"].text();
    json::read(joint, "q", state.q);
    json::read(joint, "v", state.v);
    out.joints.push_back(std::move(state));
  });
  out.where = whereOf(x);
  return out;
}

DeviceDescription deviceOf(const Value& x) {
  x.only({"kind", "type", "name", "text", "where"});
  DeviceDescription out;
  const std::string kind = x["kind"].text();
  const auto found = std::find(kindNames.begin(), kindNames.end(), kind);
  if (found == kindNames.end()) x["kind"].fail("is '" + kind + "', and must be actuator, tendon or sensor");
  out.kind = static_cast<DeviceDescription::Kind>(found - kindNames.begin());
  out.type = x["type"].text();
  if (x.has("name")) out.name = x["name"].text();
  out.text = x["text"].text();
  out.where = whereOf(x);
  return out;
}

}  // namespace

void readGroups(const Value& document, Model& model) {
  const auto each = [&](const char* key, const auto& one) {
    if (document.has(key)) document[key].each(one);
  };
  each("groups", [&](const Value& x) { model.groups.push_back(groupOf(x)); });
  each("end_effectors", [&](const Value& x) { model.end_effectors.push_back(endEffectorOf(x)); });
  each("virtual_joints", [&](const Value& x) { model.virtual_joints.push_back(virtualJointOf(x)); });
  read(document, "passive_joints", model.passive_joints);
  each("configurations", [&](const Value& x) { model.configurations.push_back(configurationOf(x)); });
  each("devices", [&](const Value& x) { model.devices.push_back(deviceOf(x)); });
}

}  // namespace dyn::json
