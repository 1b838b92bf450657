// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/draft.hpp"
#include "compile/parts.hpp"
#include "joint/coordinate.hpp"
#include "joint/pose_components.hpp"
#include "model/universe.hpp"

#include <dyn/compile/edit.hpp>
#include <dyn/near_names.hpp>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace dyn {

namespace {

/// Pose at q of one joint that is not made of joints.
SE3<double> poseOf(const DraftBody& body, const double* q) {
  double pose[12], subspace[6 * max_joint_nv];
  JointBatch<double> batch;
  batch.count = 1;
  batch.constants = body.constants.data();
  batch.constant_count = body.instance.constant_count;
  batch.constants_stride = batch.q_stride = batch.stride = 1;
  batch.q = q;
  batch.pose = pose;
  batch.subspace = body.instance.shape == Shape::dense ? subspace : nullptr;
  body.type->kinematics(batch);
  return body.instance.before * poseFromComponents(body.instance.shape, pose) * body.instance.after;
}

JointDescription rigidAt(const JointDescription& joint, const SE3<double>& pose) {
  JointDescription rigid;
  rigid.held = joint.held;
  rigid.name = joint.name;
  rigid.where = joint.where;
  rigid.placement = joint.placement * pose;
  return rigid;
}

/// The bodies that a model's joints and their parts carry, by the full names that couplings use.
std::unordered_map<std::string, int> carriersOf(const Model& model) {
  std::unordered_map<std::string, int> out;
  for (std::size_t i = 1; i < model.bodies.size(); ++i)
    visitParts(model.bodies[i].joint, model.bodies[i].joint.name,
               [&](const auto&, const std::string& name) { out.emplace(name, static_cast<int>(i)); });
  return out;
}

/// Makes joints rigid, and with them their dependent joints and parts, except those that are named to be held themselves.
class Holder {
 public:
  Holder(const Model& model, const JointRegistry& registry, const std::vector<LockedJoint>& lock)
      : model_(model), registry_(registry), carriers_(carriersOf(model)) {
    for (const LockedJoint& l : lock) {
      if (l.joint.empty()) throw Error(ErrorCode::argument, "a joint to hold has no name");
      if (!named_.emplace(l.joint, l.q).second) throw Error(ErrorCode::model, "is to be held twice; name it once", {"", 0, l.joint});
    }
    for (std::size_t i = 1; i < model.bodies.size(); ++i) {
      if (named_.count(model.bodies[i].joint.name)) continue;
      visitParts(model.bodies[i].joint, model.bodies[i].joint.name, [&](const JointDescription& joint, const std::string& name) {
        if (!joint.coupling.type.empty()) dependents_[joint.coupling.master].push_back({static_cast<int>(i), name});
      });
    }
  }

  /// Makes the joint of body `index`, which is named, and its dependent joints rigid in `out`.
  void hold(int index, Model& out) const {
    std::unordered_set<std::string> held;
    std::vector<int> bodies{index};
    std::vector<std::string> open;
    const JointDescription& named = out.bodies[at(index)].joint;
    visitParts(named, named.name, [&](const auto&, const std::string& name) { open.push_back(name); });
    held.insert(open.begin(), open.end());
    while (!open.empty()) {
      const auto found = dependents_.find(open.back());
      open.pop_back();
      if (found == dependents_.end()) continue;
      for (const Dependent& dependent : found->second) {
        if (!held.insert(dependent.name).second) continue;
        open.push_back(dependent.name);
        if (std::find(bodies.begin(), bodies.end(), dependent.body) == bodies.end()) bodies.push_back(dependent.body);
      }
    }
    // `alone` gets the joints with something to hold, each on the world, and after them the masters of these joints.
    const std::size_t with_something = bodies.size();
    for (std::size_t k = 0; k < bodies.size(); ++k)
      visitParts(out.bodies[at(bodies[k])].joint, "", [&](const JointDescription& part, const auto&) {
        const auto found = carriers_.find(part.coupling.master);
        if (found != carriers_.end() && std::find(bodies.begin(), bodies.end(), found->second) == bodies.end()) bodies.push_back(found->second);
      });
    Model alone;
    for (std::size_t k = 0; k < bodies.size(); ++k) {
      // Masters come from model_, because other entries of `lock` may have made them rigid in `out`.
      const BodyDescription& body = (k < with_something ? out : model_).bodies[at(bodies[k])];
      JointDescription joint = body.joint;
      joint.placement = {};
      // A joint that is given coordinates of its own does not depend on another.
      if (!numbersOf(joint.name).empty()) joint.coupling = {};
      alone.addBody(body.name, 0, joint);
    }
    const Draft draft = resolve(alone, registry_);
    const std::vector<SE3<double>> poses = posesOf(draft);
    bodies.resize(with_something);
    std::size_t next = 1;  // in the draft, which has a body for each joint that is not made of joints
    for (const int i : bodies) {
      JointDescription& joint = out.bodies[at(i)].joint;
      for (std::size_t k = next; k < draft.bodies.size() && draft.bodies[k].user_joint == draft.bodies[next].user_joint; ++k)
        joint.held = joint.held || draft.bodies[k].instance.nv > 0;
      if (i != index) {
        holdParts(joint, joint.name, held, draft, poses, next);
        continue;
      }
      SE3<double> pose;
      for (; next < draft.bodies.size() && draft.bodies[next].user_joint == 1; ++next)
        pose = pose * cast<double>(draft.skeleton.links[next].placement) * poses[next];
      joint = rigidAt(joint, pose);
    }
  }

 private:
  struct Dependent {
    int body;
    std::string name;
  };

  /// The coordinates at which a joint is to be held. If there are none, it is held at neutral, or where its coupling puts it.
  const std::vector<double>& numbersOf(const std::string& joint) const {
    static const std::vector<double> none;
    const auto found = named_.find(joint);
    return found == named_.end() ? none : found->second;
  }

  /// Poses of a draft's joints, each by itself, at its given coordinates or at neutral. Couplings determine the poses of dependent joints.
  /// Throws Error(size) if a joint was given another number of coordinates than it has.
  std::vector<SE3<double>> posesOf(const Draft& draft) const {
    std::vector<SE3<double>> poses(draft.bodies.size());
    std::vector<std::vector<double>> q_of(draft.bodies.size());
    std::vector<std::size_t> order;  // masters before dependent joints
    for (std::size_t i = 1; i < draft.bodies.size(); ++i) order.push_back(i);
    const auto rank = [&](std::size_t i) { return draft.bodies[i].coupling ? draft.bodies[i].coupling->rank : 0; };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    std::unordered_map<std::string, std::size_t> used;  // how many of a described joint's given coordinates are used
    Coordinates coordinates;
    for (const std::size_t i : order) {
      const DraftBody& body = draft.bodies[i];
      const auto nq = static_cast<std::size_t>(body.instance.nq);
      q_of[i].assign(nq + 1, 0.0);
      if (body.coupling) {
        const DraftBody& master = draft.bodies[at(body.coupling->master)];
        double f[4];
        const double x = coordinates.of(master.place(), q_of[at(body.coupling->master)].data());
        body.coupling->type->evaluate(body.coupling->constants.data(), static_cast<int>(body.coupling->constants.size()), x, f);
        coordinates.set(body.place(), f[0], q_of[i].data());
      } else if (const std::vector<double>& q = numbersOf(body.user_name); !q.empty()) {
        std::size_t& first = used[body.user_name];
        for (std::size_t k = 0; k < nq && first + k < q.size(); ++k) q_of[i][k] = q[first + k];
        first += nq;
      } else {
        neutralOf(body.place(), q_of[i].data());
      }
      poses[i] = poseOf(body, q_of[i].data());
    }
    for (const auto& [joint, needed] : used)
      if (needed != numbersOf(joint).size())
        throw Error(ErrorCode::size,
                    "to be held it needs " + std::to_string(needed) + " coordinates, it was given " + std::to_string(numbersOf(joint).size()),
                    {"", 0, joint});
    return poses;
  }

  /// Makes those parts of a joint (or the joint itself) rigid that are held, and removes their entries from the joint's limits and dissipation.
  /// `next` counts along the draft.
  static void holdParts(JointDescription& joint, const std::string& name, const std::unordered_set<std::string>& held, const Draft& draft,
                        const std::vector<SE3<double>>& poses, std::size_t& next) {
    const std::size_t first = next;
    auto* parts = partsOf(joint);
    if (parts == nullptr) {
      if (held.count(name)) joint = rigidAt(joint, poses[next]);
      ++next;
      return;
    }
    for (std::size_t k = 0; k < parts->size(); ++k) holdParts((*parts)[k], partName(name, (*parts)[k], k), held, draft, poses, next);
    const auto keep = [&](std::vector<double>& values, int JointInstance::*size) {
      std::vector<double> kept;
      std::size_t from = 0;
      for (std::size_t i = first; i < next; ++i) {
        const auto n = static_cast<std::size_t>(draft.bodies[i].instance.*size);
        for (std::size_t k = from; k < from + n && k < values.size(); ++k)
          if (!held.count(draft.bodies[i].joint.name)) kept.push_back(values[k]);
        from += n;
      }
      values = std::move(kept);
    };
    for (std::vector<double>* values : {&joint.limits.lower, &joint.limits.upper}) keep(*values, &JointInstance::nq);
    JointLimits& limits = joint.limits;
    for (std::vector<double>* values : {&limits.velocity, &limits.effort, &limits.acceleration, &limits.deceleration, &limits.jerk, &joint.damping,
                                        &joint.friction, &joint.armature})
      keep(*values, &JointInstance::nv);
  }

  const Model& model_;
  const JointRegistry& registry_;
  const std::unordered_map<std::string, int> carriers_;
  std::unordered_map<std::string, std::vector<double>> named_;
  std::unordered_map<std::string, std::vector<Dependent>> dependents_;
};

std::vector<std::string> jointNames(const Model& model) {
  std::vector<std::string> names;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) names.push_back(model.bodies[i].joint.name);
  return names;
}

}  // namespace

Model reduce(const Model& model, const JointRegistry& registry, const std::vector<LockedJoint>& lock) {
  requireUniverse(model);
  Model out = model;
  std::unordered_map<std::string, int> by_name;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) by_name[model.bodies[i].joint.name] = static_cast<int>(i);
  const Holder holder(model, registry, lock);
  for (const LockedJoint& l : lock) {
    const auto found = by_name.find(l.joint);
    if (found == by_name.end()) {
      throw Error(ErrorCode::model, "is to be held, but the model has no such joint" + nearNames(l.joint, jointNames(model)), {"", 0, l.joint});
    }
    holder.hold(found->second, out);
  }
  return out;
}

Model keepOnly(const Model& model, const JointRegistry& registry, const std::vector<std::string>& keep) {
  requireUniverse(model);
  const std::unordered_map<std::string, int> carriers = carriersOf(model);
  std::unordered_set<std::string> kept(keep.begin(), keep.end());
  std::vector<std::string> open = keep;
  while (!open.empty()) {
    const int i = model.findJoint(open.back());
    if (i < 0)
      throw Error(ErrorCode::model, "is to be kept, but the model has no such joint" + nearNames(open.back(), jointNames(model)),
                  {"", 0, open.back()});
    open.pop_back();
    visitParts(model.bodies[at(i)].joint, "", [&](const JointDescription& joint, const auto&) {
      const std::string& master = joint.coupling.master;
      if (master.empty()) return;
      const auto found = carriers.find(master);
      const std::string& leader = found == carriers.end() ? master : model.bodies[at(found->second)].joint.name;
      if (kept.insert(leader).second) open.push_back(leader);
    });
  }
  const auto follows = [&](const JointDescription& joint) {
    const auto found = carriers.find(joint.coupling.master);
    return found != carriers.end() && kept.count(model.bodies[at(found->second)].joint.name);
  };
  std::vector<LockedJoint> lock;
  // Dependent joints of held joints are held with them. Dependent joints of a kept joint are held at neutral if they are not kept themselves.
  Model uncoupled = model;
  for (std::size_t i = 1; i < uncoupled.bodies.size(); ++i) {
    JointDescription& joint = uncoupled.bodies[i].joint;
    if (kept.count(joint.name) || (!joint.coupling.type.empty() && !follows(joint))) continue;
    joint.coupling = {};
    lock.push_back({joint.name, {}});
  }
  return reduce(uncoupled, registry, lock);
}

}  // namespace dyn
