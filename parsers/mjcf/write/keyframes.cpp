// SPDX-License-Identifier: BSD-2-Clause
#include "keyframes.hpp"

#include "common/reader.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>

namespace dyn::mjcf {

namespace {

using Numbers = std::vector<double>;

/// A joint may follow another one, that one a third, and so on, so many times.
constexpr int most_followed = 100;

States statesIn(const ConfigurationDescription& key) {
  States out;
  for (const JointState& state : key.joints) out.emplace(state.joint, &state);
  return out;
}

const ConfigurationDescription* homeIn(const Model& model) {
  const auto found = std::find_if(model.configurations.begin(), model.configurations.end(),
                                  [](const ConfigurationDescription& c) { return c.name == "qpos0" && c.group.empty(); });
  return found == model.configurations.end() ? nullptr : &*found;
}

/// The place of a coordinate in qpos and qvel.
struct Place {
  std::size_t q, v;
};

class KeyWriter {
 public:
  KeyWriter(const Model& model, const std::vector<std::size_t>& order, const Joints& joints, const std::vector<JointChain>& chains, xml::Output& out)
      : model_(model), home_(homeIn(model)), order_(order), joints_(joints), out_(out) {
    Place next{0, 0};
    for (const std::size_t i : order)
      for (const PlainJoint& joint : chains[i].joints) {
        places_.emplace(joint.name, next);
        if (joint.type == PlainJoint::Type::free) has_free_ = true;
        next.q += joint.degrees() + (joint.axial() ? 0 : 1);
        next.v += joint.degrees();
      }
    for (std::size_t i = 1; i < model.bodies.size(); ++i) known_.insert(model.bodies[i].joint.name);
  }

  void write() {
    for (const ConfigurationDescription& key : model_.configurations) {
      if (!isSaidByPoses(key)) write(key);
    }
    if (open_) out_.close();
  }

 private:
  const BodyDescription& body(std::size_t i) const { return model_.bodies[i]; }

  /// Whether the key is the state of the bodies' poses: all joints but free ones are neutral and nothing moves.
  bool isSaidByPoses(const ConfigurationDescription& key) const {
    if (&key != home_ || !has_free_) return false;
    const States states = statesIn(key);
    for (const std::size_t i : order_) {
      const auto found = states.find(body(i).joint.name);
      if (found == states.end()) continue;
      JointState state = *found->second;
      const bool on_world = body(i).parent == 0;
      if (on_world && body(i).joint.type == "free_flyer") state.q.clear();
      Numbers q, v, neutral, rest;
      appendState(body(i).joint, on_world, state, q, v);
      appendState(body(i).joint, on_world, {}, neutral, rest);
      if (q != neutral || v != rest) return false;
    }
    return true;
  }

  void write(const ConfigurationDescription& key) {
    const States states = statesIn(key);
    for (const JointState& state : key.joints) {
      if (!known_.count(state.joint))
        throw Error(ErrorCode::model, "cannot be written: state '" + key.name + "' names joint '" + state.joint + "', which does not exist");
    }
    Numbers qpos, qvel;
    bool moves = false;
    for (const std::size_t i : order_) {
      const auto state = states.find(body(i).joint.name);
      moves = moves || (state != states.end() && !state->second->v.empty());
      appendState(body(i).joint, body(i).parent == 0, state == states.end() ? JointState{} : *state->second, qpos, qvel);
    }
    follow(qpos, qvel);
    if (!key.group.empty()) out_.lose("groups of named states (an SRDF has them)", key.name);
    const std::string name = reader::freeName(key.name, names_);
    if (name != key.name) out_.lose("names of states that several have", key.name);
    if (!open_) out_.open("keyframe");
    open_ = true;
    out_.open("key");
    out_.put("name", name);
    if (!qpos.empty()) out_.put("qpos", qpos);
    if (moves) out_.put("qvel", qvel);
    out_.close();
  }

  /// Sets the coordinates that depend on others.
  void follow(Numbers& qpos, Numbers& qvel) const {
    bool changed = true;
    for (int pass = 0; changed; ++pass) {
      if (pass > most_followed)
        throw Error(ErrorCode::model, "cannot be written: its dependent joints follow each other in a circle, or more than " +
                                          std::to_string(most_followed) + " times");
      changed = false;
      for (const Dependence& d : joints_.dependences()) {
        const auto to = places_.find(joints_.scalar(d.joint)), from = places_.find(joints_.scalar(d.master));
        if (to == places_.end() || from == places_.end()) continue;
        const double x = qpos[from->second.q], rate = qvel[from->second.v];
        double y = 0, slope = 0;
        for (std::size_t k = d.coefficients.size(); k-- > 0;) {
          slope = slope * x + y;
          y = y * x + d.coefficients[k];
        }
        changed = changed || qpos[to->second.q] != y || qvel[to->second.v] != slope * rate;
        qpos[to->second.q] = y;
        qvel[to->second.v] = slope * rate;
      }
    }
  }

  const Model& model_;
  const ConfigurationDescription* home_;
  const std::vector<std::size_t>& order_;
  const Joints& joints_;
  xml::Output& out_;
  std::unordered_map<std::string, Place> places_;
  std::set<std::string> known_, names_;
  bool has_free_ = false, open_ = false;
};

}  // namespace

States homeOf(const Model& model) {
  const ConfigurationDescription* home = homeIn(model);
  return home == nullptr ? States{} : statesIn(*home);
}

SE3<long double> startOf(const States& home, const std::string& joint, const SE3<long double>& neutral) {
  const auto state = home.find(joint);
  if (state == home.end() || state->second->q.size() != 7) return neutral;
  const Numbers& q = state->second->q;
  return neutral * SE3<long double>{Quaternion<long double>{q[3], q[4], q[5], q[6]}.normalized().matrix(), {q[0], q[1], q[2]}};
}

void writeKeyframes(const Model& model, const std::vector<std::size_t>& order, const Joints& joints, const std::vector<JointChain>& chains,
                    xml::Output& out) {
  KeyWriter(model, order, joints, chains, out).write();
}

}  // namespace dyn::mjcf
