// SPDX-License-Identifier: BSD-2-Clause
// Pinocchio: builds the tree by Pinocchio's own calls.
#include "peers/peers.hpp"

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody/data.hpp>
#include <pinocchio/multibody/model.hpp>

namespace dyn::benchmark::peers {

namespace {

namespace pin = pinocchio;

pin::Model modelOf(const Robot& robot) {
  pin::Model model;
  model.gravity.linear() << robot.gravity.x, robot.gravity.y, robot.gravity.z;
  std::vector<pin::JointIndex> ids(robot.links.size(), 0);
  for (std::size_t i = 1; i < ids.size(); ++i) {
    const Link& link = robot.links[i];
    const Sym3<double>& I = link.inertia.rotational;
    const Vec3<double>&p = link.placement.p, &c = link.inertia.com;
    Eigen::Matrix3d R, inertia;
    inertia << I.xx, I.xy, I.xz, I.xy, I.yy, I.yz, I.xz, I.yz, I.zz;
    for (int r = 0; r < 3; ++r)
      for (int k = 0; k < 3; ++k) R(r, k) = link.placement.R(r, k);
    const pin::SE3 placement(R, Eigen::Vector3d(p.x, p.y, p.z));
    const std::string name = "joint" + std::to_string(i);
    const pin::JointIndex parent = ids[static_cast<std::size_t>(link.parent)];
    if (link.motion == Motion::floating) ids[i] = model.addJoint(parent, pin::JointModelFreeFlyer(), placement, name);
    if (link.motion == Motion::revolute) ids[i] = model.addJoint(parent, pin::JointModelRZ(), placement, name);
    if (link.motion == Motion::prismatic) ids[i] = model.addJoint(parent, pin::JointModelPZ(), placement, name);
    model.appendBodyToJoint(ids[i], pin::Inertia(link.inertia.mass, Eigen::Vector3d(c.x, c.y, c.z), inertia), pin::SE3::Identity());
  }
  return model;
}

class Pinocchio : public Peer {
 public:
  explicit Pinocchio(const Robot& robot)
      : model_(modelOf(robot)), data_(model_), floating_(robot.floating), q_(pin::neutral(model_)), v_(Eigen::VectorXd::Zero(model_.nv)), a_(v_) {}
  bool can(Task) const override { return true; }
  void run(Task task, const State& s) override {
    if (floating_) {
      std::copy_n(s.base_q, 7, q_.data());
      std::copy_n(s.base_v, 6, v_.data());
      std::copy_n(s.base_a, 6, a_.data());
    }
    std::copy(s.q.begin(), s.q.end(), q_.data() + (floating_ ? 7 : 0));
    if (task == Task::crba) {
      pin::crba(model_, data_, q_, pin::Convention::WORLD);
      return;
    }
    if (task == Task::minverse) {
      pin::computeMinverse(model_, data_, q_);
      return;
    }
    std::copy(s.v.begin(), s.v.end(), v_.data() + (floating_ ? 6 : 0));
    std::copy(s.a.begin(), s.a.end(), a_.data() + (floating_ ? 6 : 0));
    if (task == Task::rnea) pin::rnea(model_, data_, q_, v_, a_);
    if (task == Task::aba) pin::aba(model_, data_, q_, v_, a_, pin::Convention::WORLD);
    if (task == Task::rnea_derivatives) pin::computeRNEADerivatives(model_, data_, q_, v_, a_);
    if (task == Task::aba_derivatives) pin::computeABADerivatives(model_, data_, q_, v_, a_);
  }
  std::vector<double> result(Task task) const override {
    const Eigen::Index n = model_.nv - (floating_ ? 6 : 0);
    Eigen::MatrixXd x;
    if (task == Task::rnea) x = data_.tau.tail(n);
    if (task == Task::aba) x = data_.ddq.tail(n);
    // x is read column by column, so matrices that are not symmetric are transposed.
    if (task == Task::crba) x = Eigen::MatrixXd(data_.M.selfadjointView<Eigen::Upper>()).bottomRightCorner(n, n);
    if (task == Task::minverse) x = Eigen::MatrixXd(data_.Minv.selfadjointView<Eigen::Upper>()).bottomRightCorner(n, n);
    if (task == Task::rnea_derivatives) x = data_.dtau_dq.bottomRightCorner(n, n).transpose();
    if (task == Task::aba_derivatives) x = data_.ddq_dq.bottomRightCorner(n, n).transpose();
    return {x.data(), x.data() + x.size()};
  }

 private:
  pin::Model model_;
  pin::Data data_;
  bool floating_;
  Eigen::VectorXd q_, v_, a_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Pinocchio(robot); }
