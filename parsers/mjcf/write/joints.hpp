// SPDX-License-Identifier: BSD-2-Clause
// libdyn's joints as MuJoCo's: a joint becomes one or several of free, ball, slide and hinge with the same motion.
#pragma once

#include "xml/output.hpp"

#include <dyn/model/model.hpp>

#include <limits>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::mjcf {

constexpr double unlimited = std::numeric_limits<double>::infinity();

/// One of MuJoCo's joints.
struct PlainJoint {
  enum class Type { free, ball, slide, hinge };
  Type type = Type::hinge;
  std::string name{};
  SE3<long double> placement{};  ///< at zero, in the frame that the joint before it moves, or in the parent body's frame
  Vec3<double> axis{};           ///< of slides and hinges, in the joint's frame
  std::size_t nq = 1, nv = 1;    ///< the number of libdyn's coordinates and degrees of freedom that it stands for
  double lower = -unlimited, upper = unlimited, effort = unlimited;
  double armature = 0, damping = 0, friction = 0;
  bool axial() const { return type == Type::slide || type == Type::hinge; }
  bool turns() const { return type == Type::ball || type == Type::hinge; }
  std::size_t degrees() const { return type == Type::free ? 6 : (type == Type::ball ? 3 : 1); }
};

/// A coordinate that is a polynomial of another one's.
struct Dependence {
  std::string joint, master;  ///< names that libdyn has for them
  std::vector<double> coefficients;
};

/// MuJoCo's joints of one of libdyn's, in order.
struct JointChain {
  std::vector<PlainJoint> joints;
  SE3<long double> after;  ///< pose of the body's frame in the frame that the last joint moves, or in the parent's if there is none
};

/// The joints of a model, with the names that are in use.
class Joints {
 public:
  explicit Joints(xml::Output& out) : out_(out) {}
  /// Keeps a name for a joint of the model.
  void reserve(const std::string& name) { names_.insert(name); }
  /// Returns a joint's chain. Throws Error(model) for a type that no joints of MuJoCo are equal to. `on_world` says that the parent is the world,
  /// where MuJoCo has free joints.
  JointChain chainOf(const JointDescription& joint, bool on_world);
  /// Returns MuJoCo's name of a joint, or a part of one, that has one degree of freedom; empty for others.
  std::string scalar(const std::string& name) const;
  const std::vector<Dependence>& dependences() const { return dependences_; }

 private:
  void add(const JointDescription& joint, const std::string& name, const SE3<long double>& placement, bool on_world, int depth, JointChain& chain);
  void addPlain(const JointDescription& joint, const std::string& name, bool on_world, JointChain& chain);
  void layOut(const JointDescription& joint, std::size_t first, const std::string& name, JointChain& chain);
  void follow(const JointDescription& joint, const std::string& name, bool scalar);

  xml::Output& out_;
  std::set<std::string> names_;
  std::unordered_map<std::string, std::string> scalars_;
  std::vector<Dependence> dependences_;
};

/// Returns the joint's coordinates and velocities in MuJoCo's order and axes at a state of it; empty vectors of the state are neutral and at rest.
/// Throws Error(model) for vectors of another size.
void appendState(const JointDescription& joint, bool on_world, const JointState& state, std::vector<double>& qpos, std::vector<double>& qvel);

/// Writes <joint> or <freejoint>. `frame` is the pose of the joint's frame in the body's.
void writeJoint(xml::Output& out, const PlainJoint& joint, const SE3<long double>& frame);

/// Whether a rotation is the identity to the last bit.
bool isIdentity(const Mat3<long double>& R);
/// Writes pos and quat of a pose, as far as they are not zero.
void putPose(xml::Output& out, const SE3<double>& X);

}  // namespace dyn::mjcf
