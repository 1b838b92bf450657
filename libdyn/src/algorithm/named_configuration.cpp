// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/named_configuration.hpp>
#include <dyn/near_names.hpp>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace dyn {

namespace {

using States = std::vector<const ConfigurationDescription*>;

bool answersTo(const ConfigurationDescription& state, const std::string& name) {
  return state.name == name || (!state.group.empty() && state.group + "/" + state.name == name);
}

States statesCalled(const Model& description, const std::string& name) {
  States out;
  for (const ConfigurationDescription& state : description.configurations)
    if (answersTo(state, name)) out.push_back(&state);
  if (!out.empty()) return out;
  std::vector<std::string> all;
  for (const ConfigurationDescription& state : description.configurations) {
    all.push_back(state.name);
    if (!state.group.empty()) all.push_back(state.group + "/" + state.name);
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  const std::string near = nearNames(name, all);
  const std::string known =
      all.empty() ? "; it has no named states (an SRDF may have)" : "; it has " + std::to_string(all.size()) + " names of states";
  throw Error(ErrorCode::argument, "the model '" + description.name + "' has no state '" + name + "'" + (near.empty() ? known : near));
}

/// The states of one name after another. A name that itself has commas is taken as it is.
std::vector<States> statesOf(const Model& description, const std::string& names) {
  for (const ConfigurationDescription& state : description.configurations)
    if (answersTo(state, names)) return {statesCalled(description, names)};
  std::vector<States> out;
  for (std::size_t first = 0, comma = 0; comma != std::string::npos; first = comma + 1) {
    comma = names.find(',', first);
    out.push_back(statesCalled(description, names.substr(first, comma == std::string::npos ? comma : comma - first)));
  }
  return out;
}

void set(const JointState& given, const JointRecord& record, const ConfigurationDescription& state, double* q, double* v) {
  const auto write = [&](const std::vector<double>& values, int size, const char* what, double* to) {
    if (values.empty()) return;
    if (values.size() != at(size))
      throw Error(ErrorCode::size,
                  "state '" + state.name + "' has " + std::to_string(values.size()) + " " + what + ", the joint's type '" + record.type + "' wants " +
                      std::to_string(size),
                  {state.where.file, state.where.line, given.joint});
    std::copy(values.begin(), values.end(), to);
  };
  write(given.q, record.nq, "coordinates", q + record.idx_q);
  write(given.v, record.nv, "velocities", v + record.idx_v);
}

}  // namespace

void detail::namedState(const CompactModel& model, const Model& description, const std::string& names, double* q, double* v) {
  std::unordered_set<std::string> described;
  for (std::size_t i = 1; i < description.bodies.size(); ++i) described.insert(description.bodies[i].joint.name);
  std::unordered_map<std::string, const JointRecord*> moving;
  for (std::size_t j = 1; j < model.joints().size(); ++j) moving.emplace(model.joints()[j].name, &model.joints()[j]);
  detail::neutral(model, q);
  std::fill_n(v, model.nv(), 0.0);
  for (const States& states : statesOf(description, names)) {
    std::unordered_map<std::string, const JointState*> given;
    for (const ConfigurationDescription* state : states)
      for (const JointState& joint : state->joints) {
        if (!described.count(joint.joint))
          throw Error(ErrorCode::model, "state '" + state->name + "' sets this joint, which the model '" + description.name + "' does not have",
                      {state->where.file, state->where.line, joint.joint});
        const auto [before, is_new] = given.emplace(joint.joint, &joint);
        if (!is_new && (before->second->q != joint.q || before->second->v != joint.v))
          throw Error(ErrorCode::argument,
                      "several states are called '" + state->name + "' and give this joint different coordinates; write '" + state->group + "/" +
                          state->name + "' for that of group '" + state->group + "'",
                      {state->where.file, state->where.line, joint.joint});
        const auto found = moving.find(joint.joint);
        if (found != moving.end() && found->second->nq > 0) set(joint, *found->second, *state, q, v);
      }
  }
}

}  // namespace dyn
