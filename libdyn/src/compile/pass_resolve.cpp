// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/parameters.hpp"
#include "compile/parts.hpp"
#include "joint/single.hpp"
#include "model/universe.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <unordered_map>

namespace dyn {

namespace {

constexpr const char* universe = "universe";

Where whereOf(const JointDescription& joint, const std::string& name) {
  Where where = joint.where;
  where.joint = name;
  return where;
}

class Resolver {
 public:
  Resolver(const Model& model, const JointRegistry& registry) : model_(model), registry_(registry) {}

  Draft run() {
    requireUniverse(model_);
    draft_.name = model_.name;
    draft_.gravity = model_.gravity;
    checkGravity(model_.gravity);
    draft_.bodies.resize(1);
    draft_.skeleton.links.resize(1);
    draft_.inertias.resize(1);
    draft_.bodies[0].name = universe;
    draft_.bodies[0].joint.name = universe;
    draft_.bodies[0].user_joint = 0;
    last_body_.assign(model_.bodies.size(), 0);
    checkNames();
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) addBody(static_cast<int>(i));
    for (const FrameDescription& frame : model_.frames) {
      if (frame.body < 0 || frame.body >= static_cast<int>(model_.bodies.size()))
        throw Error(ErrorCode::model, "frame '" + frame.name + "' is fixed to body " + std::to_string(frame.body) + ", which does not exist");
      checkPlacement(frame.placement, "frame '" + frame.name + "': its placement", {});
      draft_.skeleton.frames.push_back({last_body_[at(frame.body)], cast<long double>(frame.placement)});
      draft_.frame_names.push_back(frame.name);
    }
    resolveCouplings();
    draft_.report.passes.push_back("resolve: " + std::to_string(model_.bodies.size() - 1) + " joints, " + std::to_string(expanded_) +
                                   " of them made of parts (" + std::to_string(parts_) + ")");
    return std::move(draft_);
  }

 private:
  void checkNames() {
    std::unordered_map<std::string, int> bodies, joints;
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const BodyDescription& b = model_.bodies[i];
      if (i > 0 && (b.name == universe || b.joint.name == universe))
        throw Error(ErrorCode::model, "a body or joint is called 'universe', which is the world's own name; rename it", b.where);
      if (!bodies.emplace(b.name, 1).second) throw Error(ErrorCode::model, "two bodies are called '" + b.name + "'; rename one", b.where);
      if (i > 0 && !joints.emplace(b.joint.name, 1).second)
        throw Error(ErrorCode::model, "two joints are called '" + b.joint.name + "'; rename one", b.where);
      if (i > 0 && (b.parent < 0 || b.parent >= static_cast<int>(i)))
        throw Error(ErrorCode::model, "body '" + b.name + "': its parent must come before it in Model::bodies", b.where);
    }
    for (const DisabledCollision& d : model_.disabled_collisions)
      for (const std::string& body : {d.body, d.other})
        if (!bodies.count(body) && model_.findGeometry(body) < 0)
          draft_.report.warnings.push_back("collisions of '" + d.body + "' and '" + d.other + "' are disabled, but there is no body or volume '" +
                                           body + "': that has no effect");
    for (const FrameDescription& f : model_.frames)
      if (!bodies.emplace(f.name, 1).second) throw Error(ErrorCode::model, "two frames are called '" + f.name + "'; rename one");
  }

  void addBody(int index) {
    const BodyDescription& body = model_.bodies[at(index)];
    checkInertia(body.inertia, body.name, body.where);
    const std::size_t first = first_of_joint_ = draft_.bodies.size();
    inner_.clear();
    addJoint(body.joint, body.joint.name, last_body_[at(body.parent)], body.joint.placement, index, 0);
    for (std::size_t i = first; i < draft_.bodies.size(); ++i) {
      draft_.bodies[i].user_name = body.joint.name;
      draft_.bodies[i].user_type = body.joint.type;
    }
    draft_.bodies[first].first_part = true;
    draft_.bodies[first].user_placement = body.joint.placement;
    draft_.bodies[first].inner = inner_;
    draft_.bodies[first].held = body.joint.held;
    DraftBody& last = draft_.bodies.back();
    last.name = body.name;
    draft_.inertias.back() = cast<long double>(body.inertia);
    last.last_part = true;
    last_body_[at(index)] = static_cast<int>(draft_.bodies.size()) - 1;
  }

  void addJoint(const JointDescription& joint, const std::string& name, int parent, const SE3<double>& placement, int user, int depth) {
    const Where where = whereOf(joint, name);
    checkPlacement(joint.placement, "its placement", where);
    const std::size_t first = draft_.bodies.size();
    const JointType& type = registry_.jointType(joint.type, where);
    const CheckedParameters checked = checkParameters(joint.parameters, type.info(), where);
    if (type.info().structure == Structure::series) {
      if (depth > 8) throw Error(ErrorCode::model, "joints made of joints are nested deeper than 8", where);
      if (!joint.coupling.type.empty())
        throw Error(ErrorCode::model,
                    "follows '" + joint.coupling.master + "', but is made of joints and has no one coordinate; couple one of its parts", where);
      ++expanded_;
      expandSeries(joint, name, parent, placement, user, depth);
    } else {
      addSingle(joint, name, type, checked, parent, placement, user);
    }
    layOut(joint, first, where);
  }

  void addSingle(const JointDescription& joint, const std::string& name, const JointType& type, const CheckedParameters& checked, int parent,
                 const SE3<double>& placement, int user) {
    const Where where = whereOf(joint, name);
    DraftBody body;
    body.joint = joint;
    body.joint.name = name;
    body.user_joint = user;
    body.last_part = false;
    body.type = &type;
    body.fast = &registry_.forProcessor(type);
    const std::vector<ParameterArgument> arguments = checked.arguments();
    char message[256] = "";
    if (!type.prepare(arguments.data(), body.instance, message, sizeof message))
      throw Error(ErrorCode::parameter, "type '" + joint.type + "': " + message, where);
    JointInstance fast;
    if (!body.fast->prepare(arguments.data(), fast, message, sizeof message) || fast.shape != body.instance.shape || fast.nq != body.instance.nq ||
        fast.nv != body.instance.nv || fast.constant_count != body.instance.constant_count ||
        (body.fast != &type && !moveAlike(type, *body.fast, arguments.data(), body.instance)))
      throw Error(ErrorCode::plugin,
                  "type '" + joint.type + "': the plugin's build for this processor makes another joint of these parameters; rebuild the plugin",
                  where);
    body.constants.resize(static_cast<std::size_t>(body.instance.constant_count));
    type.constants(arguments.data(), body.constants.data());
    const JointInstance& made = body.instance;
    draft_.skeleton.links.push_back({parent, made.shape, made.nv, cast<long double>(placement), made.before, made.after});
    draft_.inertias.emplace_back();
    draft_.bodies.push_back(std::move(body));
  }

  void expandSeries(const JointDescription& joint, const std::string& name, int parent, const SE3<double>& placement, int user, int depth) {
    const auto& parts = std::get<std::vector<JointDescription>>(joint.parameters.at("parts"));
    if (parts.empty()) throw Error(ErrorCode::parameter, "type '" + joint.type + "': 'parts' is empty", whereOf(joint, name));
    for (std::size_t k = 0; k < parts.size(); ++k) {
      JointDescription part = parts[k];
      part.where = joint.where;
      if (k == 0 && draft_.bodies.size() == first_of_joint_) inner_.push_back(part.placement);
      addJoint(part, partName(name, part, k), k == 0 ? parent : static_cast<int>(draft_.bodies.size()) - 1,
               k == 0 ? placement * part.placement : part.placement, user, depth + 1);
      if (depth == 0) ++parts_;
    }
  }

  /// Distributes a joint's limits and dissipation over the bodies that it became, from `first` on. Where the joint gives none, those of its parts
  /// stay.
  void layOut(const JointDescription& joint, std::size_t first, const Where& where) {
    std::size_t nq = 0, nv = 0;
    for (std::size_t i = first; i < draft_.bodies.size(); ++i) {
      DraftBody& made = draft_.bodies[i];
      slice(joint.limits.lower, nq, made.instance.nq, made.joint.limits.lower);
      slice(joint.limits.upper, nq, made.instance.nq, made.joint.limits.upper);
      slice(joint.limits.velocity, nv, made.instance.nv, made.joint.limits.velocity);
      slice(joint.limits.effort, nv, made.instance.nv, made.joint.limits.effort);
      slice(joint.damping, nv, made.instance.nv, made.joint.damping);
      slice(joint.friction, nv, made.instance.nv, made.joint.friction);
      slice(joint.armature, nv, made.instance.nv, made.joint.armature);
      nq += static_cast<std::size_t>(made.instance.nq);
      nv += static_cast<std::size_t>(made.instance.nv);
    }
    const auto limit = [&](const char* name, const std::vector<double>& values, std::size_t size) {
      checkEntries(
          name, values, size, [](double x) { return !std::isnan(x); }, "is no number", where);
    };
    limit("lower", joint.limits.lower, nq);
    limit("upper", joint.limits.upper, nq);
    limit("velocity", joint.limits.velocity, nv);
    limit("effort", joint.limits.effort, nv);
    limit("acceleration", joint.limits.acceleration, nv);
    limit("deceleration", joint.limits.deceleration, nv);
    limit("jerk", joint.limits.jerk, nv);
    checkDissipation("damping", joint.damping, nv, where);
    checkDissipation("friction", joint.friction, nv, where);
    checkDissipation("armature", joint.armature, nv, where);
    for (std::size_t i = first; i < draft_.bodies.size(); ++i) {
      const JointLimits& limits = draft_.bodies[i].joint.limits;
      for (std::size_t k = 0; k < std::min(limits.lower.size(), limits.upper.size()); ++k)
        if (limits.lower[k] > limits.upper[k])
          throw Error(ErrorCode::model, "its lower limit is above its upper one, at coordinate " + std::to_string(k),
                      whereOf(draft_.bodies[i].joint, draft_.bodies[i].joint.name));
    }
  }

  static void slice(const std::vector<double>& all, std::size_t first, int count, std::vector<double>& part) {
    if (all.size() < first + static_cast<std::size_t>(count)) return;
    part.assign(all.begin() + static_cast<std::ptrdiff_t>(first), all.begin() + static_cast<std::ptrdiff_t>(first) + count);
  }

  void resolveCouplings() {
    std::unordered_map<std::string, int> by_name;
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i) by_name[draft_.bodies[i].joint.name] = static_cast<int>(i);
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i) {
      DraftBody& body = draft_.bodies[i];
      const Coupling& c = body.joint.coupling;
      if (c.type.empty()) continue;
      const Where where = whereOf(body.joint, body.joint.name);
      DraftCoupling coupling;
      std::tie(coupling.type, coupling.constants) = prepareCoupling(c, registry_, where);
      const auto master = by_name.find(c.master);
      if (master == by_name.end()) throw Error(ErrorCode::model, "follows joint '" + c.master + "', which does not exist", where);
      coupling.master = master->second;
      const DraftBody& leader = draft_.bodies[at(coupling.master)];
      if (body.instance.nv > 1 || leader.instance.nv > 1)
        throw Error(ErrorCode::model, "follows '" + c.master + "': only joints of one degree of freedom can be coupled", where);
      if (body.instance.nv > 0 && leader.instance.nv == 0)
        throw Error(ErrorCode::model, "follows '" + c.master + "', which is rigid; follow a joint that moves, or make this one rigid, too", where);
      if (body.instance.nv == 0) {
        draft_.report.warnings.push_back("joint '" + body.joint.name + "' is rigid: that it follows '" + c.master + "' has no effect");
        continue;
      }
      body.coupling = std::move(coupling);
    }
    rankCouplings();
  }

  /// Counts the masters above each dependent joint. Each body is visited once, however long the chains are.
  void rankCouplings() {
    constexpr int unknown = -1, open = -2;
    std::vector<int> rank(draft_.bodies.size(), unknown);
    std::vector<int> path;
    for (std::size_t i = 1; i < draft_.bodies.size(); ++i) {
      int k = static_cast<int>(i);
      for (; rank[at(k)] == unknown && draft_.bodies[at(k)].coupling; k = draft_.bodies[at(k)].coupling->master) {
        rank[at(k)] = open;
        path.push_back(k);
      }
      if (rank[at(k)] == open)
        throw Error(ErrorCode::model, "follows itself through a circle of couplings",
                    whereOf(draft_.bodies[at(k)].joint, draft_.bodies[at(k)].joint.name));
      if (rank[at(k)] == unknown) rank[at(k)] = 0;
      for (int above = rank[at(k)]; !path.empty(); path.pop_back()) {
        rank[at(path.back())] = ++above;
        draft_.bodies[at(path.back())].coupling->rank = above;
      }
    }
  }

  const Model& model_;
  const JointRegistry& registry_;
  Draft draft_;
  std::vector<int> last_body_;  // described body -> draft body
  std::size_t first_of_joint_ = 0;
  std::vector<SE3<double>> inner_;  // DraftBody::inner of the present joint
  int expanded_ = 0, parts_ = 0;
};

}  // namespace

Draft resolve(const Model& model, const JointRegistry& registry) { return Resolver(model, registry).run(); }

}  // namespace dyn
