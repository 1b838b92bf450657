// SPDX-License-Identifier: BSD-2-Clause
#include "common/attached.hpp"
#include "common/inertia.hpp"
#include "common/reader.hpp"
#include "devices.hpp"
#include "equality.hpp"
#include "keyframes.hpp"
#include "mjcf/scene.hpp"
#include "volumes.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/mjcf.hpp>

#include <algorithm>

namespace dyn::mjcf {

namespace {

/// The deepest nesting of bodies. tinyxml2 takes 100 levels with the document; a body is in <worldbody> in <mujoco> and has elements itself.
constexpr int most_nested = 96;
/// The smallest mass and moment of inertia of bodies that move in MuJoCo.
constexpr double least_moving = 1e-15;

class Writer {
 public:
  explicit Writer(const Model& model)
      : model_(model), attached_(model), joints_(out_), volumes_(model, out_), equality_(model, out_, namesOf(model)), names_(namesOf(model)) {
    for (const BodyDescription& body : model.bodies) joints_.reserve(body.joint.name);
    chains_.resize(model.bodies.size());
    for (std::size_t i = 1; i < model.bodies.size(); ++i) chains_[i] = joints_.chainOf(model.bodies[i].joint, model.bodies[i].parent == 0);
    findMerged();
    findHeavy();
    body_names_.push_back("world");
    for (std::size_t i = 1; i < model.bodies.size(); ++i) {
      const std::string& name = model.bodies[i].name;
      body_names_.push_back(name == "world" ? reader::freeName(name, names_) : name);
      if (body_names_[i] != name) out_.lose("names of bodies that are called as MuJoCo's world is", name);
    }
  }

  Written write() {
    out_.open("mujoco");
    out_.put("model", model_.name);
    out_.open("compiler");
    out_.put("angle", "radian");
    out_.put("autolimits", "true");
    out_.put("inertiafromgeom", "false");
    out_.close();
    out_.element("option", "gravity", model_.gravity);
    volumes_.writeAssets();
    out_.open("worldbody");
    if (!isMassless(model_.bodies[0].inertia)) out_.lose("the mass of the world");
    writeFixedTo(0, true);
    for (const std::size_t i : attached_.children[0]) writeBody(i, true, 1);
    out_.close();
    writeExcludes();
    equality_.write(joints_);
    writeKeyframes(model_, order_, joints_, chains_, out_);
    writeDevices(model_, joints_, out_);
    out_.loseGroups(model_);
    out_.close();
    return {out_.text(), out_.lost()};
  }

 private:
  static std::set<std::string> namesOf(const Model& model) {
    std::set<std::string> out{"world"};
    for (const BodyDescription& body : model.bodies) out.insert(body.name);
    for (const FrameDescription& frame : model.frames) out.insert(frame.name);
    return out;
  }

  static bool isMassless(const Inertia<double>& Y) {
    const Sym3<double>& I = Y.rotational;
    return Y.mass == 0 && I.xx == 0 && I.xy == 0 && I.xz == 0 && I.yy == 0 && I.yz == 0 && I.zz == 0;
  }

  static std::size_t degrees(const JointChain& chain) {
    std::size_t out = 0;
    for (const PlainJoint& joint : chain.joints) out += joint.degrees();
    return out;
  }

  /// Finds the bodies that only carry the next one's joints. MuJoCo wants mass of bodies that move, but a body may have several joints.
  void findMerged() {
    merged_.assign(model_.bodies.size(), false);
    std::vector<std::size_t> total(model_.bodies.size(), 0);  // degrees of freedom with those of the bodies that are merged into this one
    for (std::size_t i = 1; i < model_.bodies.size(); ++i) {
      const BodyDescription& body = model_.bodies[i];
      const auto parent = static_cast<std::size_t>(body.parent);
      total[i] = degrees(chains_[i]) + (merged_[parent] ? total[parent] : 0);
      if (chains_[i].joints.empty() || attached_.children[i].size() != 1 || !isMassless(body.inertia)) continue;
      if (!attached_.volumes[i].empty() || !equality_.sites()[i].empty()) continue;
      const std::size_t next = attached_.children[i][0];
      const JointChain& below = chains_[next];
      const std::string carrier = model_.bodies[next].name + "_" + chains_[i].joints.back().name;
      const bool has_ball = std::any_of(chains_[i].joints.begin(), chains_[i].joints.end(), [](const PlainJoint& j) { return !j.axial(); });
      // A ball's coordinates depend on the axes of its frame.
      const bool ball_fits = below.joints.empty() && isIdentity(chains_[i].after.R) && isIdentity(below.after.R);
      if (chains_[i].joints[0].type == PlainJoint::Type::free || (has_ball && !ball_fits)) continue;
      if (below.joints.empty() ? body.name != carrier : total[i] + degrees(below) > 6) continue;
      merged_[i] = true;
      if (body.name != carrier) out_.lose("bodies without mass and volumes, which become joints of the next body", body.name);
    }
  }

  /// Finds the bodies that have mass and inertia, alone or with bodies that are fixed to them.
  void findHeavy() {
    heavy_.assign(model_.bodies.size(), false);
    for (std::size_t i = model_.bodies.size(); i-- > 1;) {
      const Inertia<double>& Y = model_.bodies[i].inertia;
      if (Y.mass >= least_moving && Y.rotational.xx + Y.rotational.yy + Y.rotational.zz >= 2 * least_moving) heavy_[i] = true;
      if (heavy_[i] && chains_[i].joints.empty()) heavy_[static_cast<std::size_t>(model_.bodies[i].parent)] = true;
    }
  }

  /// Writes a body with the bodies that it carries. `still` says that its parent cannot move.
  void writeBody(std::size_t i, bool still, int depth) {
    std::vector<PlainJoint> joints;
    SE3<long double> after;
    for (;; i = attached_.children[i][0]) {
      order_.push_back(i);
      SE3<long double> before = after;
      for (const PlainJoint& joint : chains_[i].joints) {
        joints.push_back(joint);
        joints.back().placement = before * joint.placement;
        before = {};
      }
      after = before * chains_[i].after;
      if (!merged_[i]) break;
    }
    const BodyDescription& body = model_.bodies[i];
    if (chains_[i].joints.empty() && body.joint.name != body.name + "_fixed") out_.lose("names of fixed joints", body.joint.name);
    still = still && joints.empty();
    if (!joints.empty() && !heavy_[i]) out_.lose("bodies that move without mass or without inertia, which MuJoCo refuses", body.name);
    int opened = 0;
    for (std::size_t first = 0;; ++opened) {
      if (depth + opened > most_nested)
        throw Error(ErrorCode::model,
                    "cannot be written as MJCF: its bodies are nested deeper than " + std::to_string(most_nested) +
                        ", which readers of XML refuse; .dyn.json holds them",
                    {body.where.file, body.where.line, body.joint.name});
      const std::size_t end = first + together(joints, first, after);
      const bool last = end == joints.size();
      const std::string name = last ? body_names_[i] : reader::freeName(body_names_[i] + "_" + joints[end - 1].name, names_);
      if (!last) out_.lose("joints that no body of MuJoCo has together, between which is a body without mass, which MuJoCo refuses", body.joint.name);
      openBody(name, joints, first, end, last ? after : SE3<long double>{});
      first = end;
      if (last) break;
    }
    writeInertial(body);
    writeFixedTo(i, still);
    for (const std::size_t child : attached_.children[i]) writeBody(child, still, depth + opened + 1);
    for (int k = 0; k <= opened; ++k) out_.close();
  }

  /// The number of joints from `first` on that one body can have: at most six degrees of freedom, and no rotation after a ball.
  static std::size_t together(const std::vector<PlainJoint>& joints, std::size_t first, const SE3<long double>& after) {
    std::size_t degrees = 0;
    for (std::size_t k = first; k < joints.size(); ++k) {
      degrees += joints[k].degrees();
      if (degrees > 6) return k - first;
      if (joints[k].axial()) continue;
      Mat3<long double> R = after.R;
      bool rotation = false;
      for (std::size_t l = joints.size(); --l > k;) {
        R = joints[l].placement.R * R;
        rotation = rotation || joints[l].turns();
      }
      if (rotation || !isIdentity(R)) return k + 1 - first;
    }
    return joints.size() - first;
  }

  /// Opens <body> and writes its joints. `after` is the pose of the body's frame in the frame that the last joint moves.
  void openBody(const std::string& name, const std::vector<PlainJoint>& joints, std::size_t first, std::size_t end, const SE3<long double>& after) {
    std::vector<SE3<long double>> below(end - first + 1, after);  // pose of the body's frame as each joint's frame sees it
    for (std::size_t k = end; k-- > first;) {
      if (k + 1 < end) below[k - first] = joints[k + 1].placement * below[k + 1 - first];
    }
    SE3<long double> pose = first < end ? joints[first].placement * below[0] : after;
    if (first < end && joints[first].type == PlainJoint::Type::free) pose = startOf(home_, joints[first].name, pose);
    out_.open("body");
    out_.put("name", name);
    putPose(out_, cast<double>(pose));
    for (std::size_t k = first; k < end; ++k) writeJoint(out_, joints[k], below[k - first].inverse());
  }

  void writeInertial(const BodyDescription& body) {
    const Inertia<double>& Y = body.inertia;
    if (isMassless(Y)) return;
    const reader::InertiaFaults faults = reader::faultsOf(Y);
    if (faults.indefinite || faults.unreal) out_.lose("inertias that no body has, which MuJoCo refuses", body.name);
    const Sym3<double>& I = Y.rotational;
    out_.open("inertial");
    out_.put("pos", Y.com);
    out_.put("mass", Y.mass);
    if (I.xy == 0 && I.xz == 0 && I.yz == 0) {
      out_.put("diaginertia", std::vector<double>{I.xx, I.yy, I.zz});
    } else {
      out_.put("fullinertia", std::vector<double>{I.xx, I.yy, I.zz, I.xy, I.xz, I.yz});
    }
    out_.close();
  }

  void writeFixedTo(std::size_t i, bool still) {
    for (const GeometryDescription* g : attached_.volumes[i]) volumes_.write(*g, still);
    for (const Site& site : equality_.sites()[i]) {
      out_.open("site");
      out_.put("name", site.name);
      putPose(out_, site.pose);
      out_.close();
    }
  }

  void writeExcludes() {
    std::unordered_map<std::string, std::size_t> bodies;
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) bodies.emplace(model_.bodies[i].name, i);
    std::set<std::pair<std::size_t, std::size_t>> written;
    for (const DisabledCollision& d : model_.disabled_collisions) {
      const auto one = bodies.find(d.body), other = bodies.find(d.other);
      const bool of_volumes = one == bodies.end() || other == bodies.end();
      if (of_volumes && !volumes_.saysPairs()) out_.lose("pairs of volumes without collision checks, for which contype has too few bits", d.body);
      if (!d.reason.empty() && d.reason != (of_volumes ? mask_reason : "exclude") && d.reason != parent_reason)
        out_.lose("reasons of pairs without collision checks", d.reason);
      if (of_volumes) continue;
      // Bodies that became joints have no volumes.
      if (merged_[one->second] || merged_[other->second] || one == other) continue;
      if (!written.insert(std::minmax(one->second, other->second)).second) continue;
      if (written.size() == 1) out_.open("contact");
      out_.open("exclude");
      out_.put("body1", body_names_[one->second]);
      out_.put("body2", body_names_[other->second]);
      out_.close();
    }
    if (!written.empty()) out_.close();
  }

  const Model& model_;
  xml::Output out_{"MJCF"};
  const reader::Attached attached_;
  Joints joints_;
  Volumes volumes_;
  EqualityWriter equality_;
  std::set<std::string> names_;          ///< of bodies and frames
  std::vector<std::string> body_names_;  ///< in MJCF
  std::vector<JointChain> chains_;       ///< of each body
  std::vector<bool> merged_, heavy_;
  const States home_ = homeOf(model_);
  std::vector<std::size_t> order_;  ///< the bodies in the file's order
};

}  // namespace

Written write(const Model& model) { return Writer(model).write(); }

std::vector<std::string> save(const Model& model, const std::string& path) {
  Written written = write(model);
  replaceFile(path, written.text);
  return std::move(written.lost);
}

}  // namespace dyn::mjcf
