// SPDX-License-Identifier: BSD-2-Clause
// Orocos KDL: inverse dynamics of trees; mass matrix and forward dynamics of chains only. KDL has no floating base.
#include "peers/peers.hpp"

#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/tree.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>

#include <optional>
#include <stdexcept>

namespace dyn::benchmark::peers {

namespace {

KDL::Vector vector(const Vec3<double>& x) { return {x.x, x.y, x.z}; }

KDL::Tree treeOf(const Robot& robot) {
  KDL::Tree tree("link0");
  for (std::size_t i = 1; i < robot.links.size(); ++i) {
    const Link& link = robot.links[i];
    const SE3<double>& X = link.placement;
    const KDL::Frame placement(KDL::Rotation(X.R(0, 0), X.R(0, 1), X.R(0, 2), X.R(1, 0), X.R(1, 1), X.R(1, 2), X.R(2, 0), X.R(2, 1), X.R(2, 2)),
                               vector(X.p));
    const auto axis = link.motion == Motion::revolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
    const std::string number = std::to_string(i);
    const KDL::Joint joint("joint" + number, vector(X.p), vector(X.R.col(2)), axis);
    const Sym3<double>& I = link.inertia.rotational;
    const KDL::RigidBodyInertia inertia(link.inertia.mass, vector(link.inertia.com), KDL::RotationalInertia(I.xx, I.yy, I.zz, I.xy, I.xz, I.yz));
    if (!tree.addSegment(KDL::Segment("link" + number, joint, placement, inertia), "link" + std::to_string(link.parent)))
      throw std::runtime_error("no such parent");
  }
  return tree;
}

class Kdl : public Peer {
 public:
  explicit Kdl(const Robot& robot)
      : tree_(treeOf(robot)), inverse_(tree_, vector(robot.gravity)), q_(n(robot)), v_(n(robot)), a_(n(robot)), tau_(n(robot)), M_(n(robot)) {
    for (std::size_t i = 1; i < robot.links.size(); ++i)
      if (robot.links[i].parent != static_cast<int>(i) - 1) return;
    if (!tree_.getChain("link0", "link" + std::to_string(robot.joints), chain_)) return;
    mass_.emplace(chain_, vector(robot.gravity));
    forward_.emplace(chain_, vector(robot.gravity));
    chain_forces_.resize(chain_.getNrOfSegments(), KDL::Wrench::Zero());
  }
  bool can(Task task) const override { return task == Task::rnea || (isBasic(task) && mass_.has_value()); }
  void run(Task task, const State& s) override {
    const auto fill = [](const std::vector<double>& from, KDL::JntArray& to) { std::copy(from.begin(), from.end(), to.data.data()); };
    fill(s.q, q_);
    if (task == Task::crba) {
      mass_->JntToMass(q_, M_);
      return;
    }
    fill(s.v, v_);
    if (task == Task::rnea) {
      fill(s.a, a_);
      inverse_.CartToJnt(q_, v_, a_, forces_, tau_);
    } else {
      fill(s.a, tau_);
      forward_->CartToJnt(q_, v_, tau_, chain_forces_, a_);
    }
  }
  std::vector<double> result(Task task) const override {
    if (task == Task::crba) return {M_.data.data(), M_.data.data() + M_.data.size()};
    const KDL::JntArray& x = task == Task::rnea ? tau_ : a_;
    return {x.data.data(), x.data.data() + x.data.size()};
  }

 private:
  static unsigned n(const Robot& robot) { return static_cast<unsigned>(robot.joints); }
  KDL::Tree tree_;
  KDL::TreeIdSolver_RNE inverse_;
  KDL::Chain chain_;
  std::optional<KDL::ChainDynParam> mass_;
  std::optional<KDL::ChainFdSolver_RNE> forward_;
  KDL::Wrenches chain_forces_;
  KDL::WrenchMap forces_;
  KDL::JntArray q_, v_, a_, tau_;
  KDL::JntSpaceInertiaMatrix M_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) {
  return robot.floating ? nullptr : new dyn::benchmark::peers::Kdl(robot);
}
