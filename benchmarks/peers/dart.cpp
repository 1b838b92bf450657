// SPDX-License-Identifier: BSD-2-Clause
// DART: builds the tree by DART's own calls, without a World and without collision.
#include "peers/peers.hpp"

// DART's umbrella header is not used, because it includes a header that Debian's package lacks.
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/PrismaticJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>

namespace dyn::benchmark::peers {

namespace {

using dart::dynamics::BodyNode;

Eigen::Isometry3d isometry(const SE3<double>& X) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear() = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(X.R.m);
  T.translation() << X.p.x, X.p.y, X.p.z;
  return T;
}

template <class Joint>
struct Of {
  using type = Joint;
};

class Dart : public Peer {
 public:
  explicit Dart(const Robot& robot) : skeleton_(dart::dynamics::Skeleton::create(robot.name)), floating_(robot.floating) {
    std::vector<BodyNode*> bodies(robot.links.size(), nullptr);
    for (std::size_t i = 1; i < bodies.size(); ++i) {
      const Link& link = robot.links[i];
      const Sym3<double>& I = link.inertia.rotational;
      BodyNode::Properties body;
      body.mName = "link" + std::to_string(i);
      body.mInertia = dart::dynamics::Inertia(link.inertia.mass, {link.inertia.com.x, link.inertia.com.y, link.inertia.com.z},
                                              (Eigen::Matrix3d() << I.xx, I.xy, I.xz, I.xy, I.yy, I.yz, I.xz, I.yz, I.zz).finished());
      const auto add = [&](auto joint, auto&& set) {
        using Joint = typename decltype(joint)::type;
        typename Joint::Properties properties;
        properties.mName = "joint" + std::to_string(i);
        properties.mT_ParentBodyToJoint = isometry(link.placement);
        set(properties);
        bodies[i] = skeleton_->createJointAndBodyNodePair<Joint>(bodies[static_cast<std::size_t>(link.parent)], properties, body).second;
      };
      const auto along_z = [](auto& joint) { joint.mAxis = Eigen::Vector3d::UnitZ(); };
      if (link.motion == Motion::floating) add(Of<dart::dynamics::FreeJoint>(), [](auto&) {});
      if (link.motion == Motion::revolute) add(Of<dart::dynamics::RevoluteJoint>(), along_z);
      if (link.motion == Motion::prismatic) add(Of<dart::dynamics::PrismaticJoint>(), along_z);
    }
    const Vec3<double>& g = robot.gravity;
    skeleton_->setGravity({g.x, g.y, g.z});
    q_ = v_ = a_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(skeleton_->getNumDofs()));
  }
  bool can(Task task) const override { return isBasic(task); }
  void run(Task task, const State& s) override {
    const Eigen::Index first = floating_ ? 6 : 0;
    if (floating_) {
      Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
      T.linear() = Eigen::Quaterniond(s.base_q[6], s.base_q[3], s.base_q[4], s.base_q[5]).toRotationMatrix();
      T.translation() << s.base_q[0], s.base_q[1], s.base_q[2];
      q_.head<6>() = dart::dynamics::FreeJoint::convertToPositions(T);
      for (int k = 0; k < 3; ++k) {  // angular first
        v_[k] = s.base_v[3 + k];
        v_[3 + k] = s.base_v[k];
        a_[k] = s.base_a[3 + k];
        a_[3 + k] = s.base_a[k];
      }
    }
    std::copy(s.q.begin(), s.q.end(), q_.data() + first);
    skeleton_->setPositions(q_);
    if (task == Task::crba) {
      M_ = &skeleton_->getMassMatrix();
      return;
    }
    std::copy(s.v.begin(), s.v.end(), v_.data() + first);
    std::copy(s.a.begin(), s.a.end(), a_.data() + first);
    skeleton_->setVelocities(v_);
    if (task == Task::rnea) {
      skeleton_->setAccelerations(a_);
      skeleton_->computeInverseDynamics();
    } else {
      skeleton_->setForces(a_);
      skeleton_->computeForwardDynamics();
    }
  }
  std::vector<double> result(Task task) const override {
    const Eigen::Index first = floating_ ? 6 : 0, n = q_.size() - first;
    Eigen::MatrixXd x;
    if (task == Task::rnea) x = skeleton_->getForces().tail(n);
    if (task == Task::crba) x = M_->bottomRightCorner(n, n);
    if (task == Task::aba) x = skeleton_->getAccelerations().tail(n);
    return {x.data(), x.data() + x.size()};
  }

  std::vector<std::string> integrators() const override {
    return floating_ ? std::vector<std::string>() : std::vector<std::string>{"semi-implicit Euler"};
  }
  std::vector<double> move(const std::string&, const std::vector<double>& q, double time, int steps) override {
    skeleton_->setPositions(Eigen::Map<const Eigen::VectorXd>(q.data(), static_cast<Eigen::Index>(q.size())));
    skeleton_->setVelocities(Eigen::VectorXd::Zero(q_.size()));
    skeleton_->setForces(Eigen::VectorXd::Zero(q_.size()));
    // These are the calls of DART's World in a step without contacts.
    for (int k = 0; k < steps; ++k) {
      skeleton_->computeForwardDynamics();
      skeleton_->integrateVelocities(time / steps);
      skeleton_->integratePositions(time / steps);
    }
    const Eigen::VectorXd end = skeleton_->getPositions();
    return {end.begin(), end.end()};
  }

 private:
  dart::dynamics::SkeletonPtr skeleton_;
  bool floating_;
  Eigen::VectorXd q_, v_, a_;
  const Eigen::MatrixXd* M_ = nullptr;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Dart(robot); }
