#include "compile/draft.hpp"
#include "joint/coordinate.hpp"
#include "joint/pose_components.hpp"

#include <dyn/compile/edit.hpp>

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

namespace dyn {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Pose of one joint that is not made of others, at q.
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

/// Makes joints rigid, and with them those that follow them, but for those that are named to be held themselves.
class Holder {
 public:
  Holder(const Model& model, const JointRegistry& registry, const std::unordered_set<std::string>& named) : model_(model), registry_(registry) {
    for (std::size_t i = 1; i < model.bodies.size(); ++i) {
      const JointDescription& joint = model.bodies[i].joint;
      if (!joint.coupling.type.empty() && !named.count(joint.name)) followers_[joint.coupling.master].push_back(static_cast<int>(i));
    }
  }

  /// Makes body `index` and its followers rigid in `out`.
  void hold(int index, const std::vector<double>& q, Model& out) const {
    std::vector<int> held{index};
    for (std::size_t k = 0; k < held.size(); ++k) {
      const auto found = followers_.find(model_.bodies[at(held[k])].joint.name);
      if (found != followers_.end()) held.insert(held.end(), found->second.begin(), found->second.end());
      if (held.size() > model_.bodies.size())
        throw Error(ErrorCode::model, "follows itself through a circle of couplings", {"", 0, model_.bodies[at(index)].joint.name});
    }
    Model alone;  // the held joints, each on the world, masters before followers
    for (const int i : held) {
      JointDescription joint = model_.bodies[at(i)].joint;
      joint.placement = {};
      if (i == index) joint.coupling = {};
      alone.addBody(model_.bodies[at(i)].name, 0, joint);
    }
    const std::vector<SE3<double>> poses = heldPoses(resolve(alone, registry_), held.size(), q);
    for (std::size_t k = 0; k < held.size(); ++k) {
      const JointDescription& joint = model_.bodies[at(held[k])].joint;
      JointDescription rigid;
      rigid.name = joint.name;
      rigid.where = joint.where;
      rigid.placement = joint.placement * poses[k];
      out.bodies[at(held[k])].joint = std::move(rigid);
    }
  }

 private:
  /// Poses of the described joints of a draft: the first at q (or neutral), the others where the couplings put them.
  static std::vector<SE3<double>> heldPoses(const Draft& draft, std::size_t joints, const std::vector<double>& q) {
    std::vector<SE3<double>> poses(joints);
    std::vector<std::vector<double>> q_of(draft.bodies.size());
    std::size_t used = 0;
    for (std::size_t i = 1; i < draft.bodies.size(); ++i) {
      const DraftBody& body = draft.bodies[i];
      const auto nq = static_cast<std::size_t>(body.instance.nq);
      q_of[i].assign(nq + 1, 0.0);
      if (body.coupling) {
        const DraftBody& master = draft.bodies[at(body.coupling->master)];
        double f[4];
        const double x = coordinateOf(*master.type, master.constants.data(), 1, q_of[at(body.coupling->master)].data());
        body.coupling->type->evaluate(body.coupling->constants.data(), static_cast<int>(body.coupling->constants.size()), x, f);
        setCoordinate(*body.type, body.constants.data(), 1, f[0], q_of[i].data());
      } else if (body.user_joint == 1 && !q.empty()) {
        for (std::size_t k = 0; k < nq && used + k < q.size(); ++k) q_of[i][k] = q[used + k];
        used += nq;
      } else {
        neutralOf(*body.type, body.constants.data(), 1, q_of[i].data());
      }
      SE3<double>& pose = poses[at(body.user_joint) - 1];
      pose = pose * cast<double>(body.placement) * poseOf(body, q_of[i].data());
    }
    if (used != q.size())
      throw Error(ErrorCode::size, "to be held it needs " + std::to_string(used) + " coordinates, it was given " + std::to_string(q.size()),
                  {"", 0, draft.bodies[1].user_name});
    return poses;
  }

  const Model& model_;
  const JointRegistry& registry_;
  std::unordered_map<std::string, std::vector<int>> followers_;
};

/// Names of an appended model get its prefix; its universe is where it hangs.
void moveConstraint(ConstraintDescription& c, const std::string& prefix, const std::string& at, const SE3<double>& placement) {
  const auto moveFrame = [&](std::string& frame, SE3<double>& pose) {
    if (frame == "universe") {
      frame = at;
      pose = placement * pose;
    } else {
      frame = prefix + frame;
    }
  };
  if (auto* frames = std::get_if<FrameConstraint>(&c.relation)) {
    moveFrame(frames->frame, frames->placement);
    moveFrame(frames->other, frames->other_placement);
  } else if (auto* coupling = std::get_if<JointCoupling>(&c.relation)) {
    coupling->joint = prefix + coupling->joint;
    coupling->coupling.master = prefix + coupling->coupling.master;
  } else {
    auto& lock = std::get<JointLock>(c.relation);
    lock.joint = prefix + lock.joint;
  }
}

}  // namespace

Model reduce(const Model& model, const JointRegistry& registry, const std::vector<LockedJoint>& lock) {
  Model out = model;
  std::unordered_map<std::string, int> by_name;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) by_name[model.bodies[i].joint.name] = static_cast<int>(i);
  std::unordered_set<std::string> named;
  for (const LockedJoint& l : lock)
    if (!named.insert(l.joint).second) throw Error(ErrorCode::model, "is to be held twice; name it once", {"", 0, l.joint});
  const Holder holder(model, registry, named);
  for (const LockedJoint& l : lock) {
    const auto found = by_name.find(l.joint);
    if (found == by_name.end()) throw Error(ErrorCode::model, "is to be held, but the model has no such joint", {"", 0, l.joint});
    holder.hold(found->second, l.q, out);
  }
  return out;
}

Model keepOnly(const Model& model, const JointRegistry& registry, const std::vector<std::string>& keep) {
  std::unordered_set<std::string> kept(keep.begin(), keep.end());
  std::vector<std::string> open = keep;
  while (!open.empty()) {
    const int i = model.findJoint(open.back());
    if (i < 0) throw Error(ErrorCode::model, "is to be kept, but the model has no such joint", {"", 0, open.back()});
    open.pop_back();
    const std::string& master = model.bodies[at(i)].joint.coupling.master;
    if (!master.empty() && kept.insert(master).second) open.push_back(master);
  }
  std::vector<LockedJoint> lock;
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const JointDescription& joint = model.bodies[i].joint;
    // Followers of held joints are held with them.
    if (!kept.count(joint.name) && joint.coupling.type.empty()) lock.push_back({joint.name, {}});
  }
  // Followers of a kept joint that are not kept themselves stand still at their neutral.
  Model uncoupled = model;
  for (BodyDescription& body : uncoupled.bodies) {
    if (kept.count(body.joint.name) || body.joint.coupling.type.empty() || !kept.count(body.joint.coupling.master)) continue;
    body.joint.coupling = {};
    lock.push_back({body.joint.name, {}});
  }
  return reduce(uncoupled, registry, lock);
}

Model append(const Model& model, const Model& other, const std::string& at, const SE3<double>& placement, const std::string& prefix) {
  Model out = model;
  int carrier = out.findBody(at);
  SE3<double> pose = placement;
  for (const FrameDescription& frame : model.frames) {
    if (carrier >= 0 || frame.name != at) continue;
    carrier = frame.body;
    pose = frame.placement * placement;
  }
  if (carrier < 0) throw Error(ErrorCode::model, "append: there is no body or frame '" + at + "'");
  std::unordered_set<std::string> bodies, joints;
  for (const BodyDescription& b : out.bodies) {
    bodies.insert(b.name);
    joints.insert(b.joint.name);
  }
  for (const FrameDescription& f : out.frames) bodies.insert(f.name);
  const auto unique = [](std::unordered_set<std::string>& names, const std::string& name) {
    if (!names.insert(name).second) throw Error(ErrorCode::model, "append: '" + name + "' would be there twice; give the copy a prefix");
  };
  const int offset = static_cast<int>(out.bodies.size()) - 1;
  // What hung on the copy's world hangs where the copy does.
  const auto rehang = [&](int& body, SE3<double>& X) {
    if (body == 0) {
      X = pose * X;
      body = carrier;
    } else {
      body += offset;
    }
  };
  for (std::size_t i = 1; i < other.bodies.size(); ++i) {
    BodyDescription body = other.bodies[i];
    body.name = prefix + body.name;
    body.joint.name = prefix + body.joint.name;
    if (!body.joint.coupling.type.empty()) body.joint.coupling.master = prefix + body.joint.coupling.master;
    unique(bodies, body.name);
    unique(joints, body.joint.name);
    rehang(body.parent, body.joint.placement);
    out.bodies.push_back(std::move(body));
  }
  for (FrameDescription frame : other.frames) {
    frame.name = prefix + frame.name;
    unique(bodies, frame.name);
    rehang(frame.body, frame.placement);
    out.frames.push_back(std::move(frame));
  }
  std::unordered_set<std::string> names;
  for (const ConstraintDescription& c : out.constraints) names.insert(c.name);
  for (ConstraintDescription c : other.constraints) {
    c.name = prefix + c.name;
    unique(names, c.name);
    moveConstraint(c, prefix, at, placement);
    out.constraints.push_back(std::move(c));
  }
  names.clear();
  for (const GeometryDescription& g : out.geometries) names.insert(g.name);
  for (GeometryDescription g : other.geometries) {
    g.name = prefix + g.name;
    unique(names, g.name);
    rehang(g.body, g.placement);
    out.geometries.push_back(std::move(g));
  }
  for (const DisabledCollision& d : other.disabled_collisions) out.disabled_collisions.push_back({prefix + d.body, prefix + d.other, d.reason});
  for (const std::string& note : other.notes) out.notes.push_back(note);
  return out;
}

}  // namespace dyn
