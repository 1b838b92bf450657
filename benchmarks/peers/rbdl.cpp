// SPDX-License-Identifier: BSD-2-Clause
// RBDL: builds the tree by RBDL's own calls.
#include "peers/peers.hpp"

#include <rbdl/rbdl.h>

namespace dyn::benchmark::peers {

namespace {

namespace R = RigidBodyDynamics;
using R::Math::Matrix3d, R::Math::MatrixNd, R::Math::Vector3d, R::Math::VectorNd;

class Rbdl : public Peer {
 public:
  explicit Rbdl(const Robot& robot) : floating_(robot.floating) {
    model_.gravity = Vector3d(robot.gravity.x, robot.gravity.y, robot.gravity.z);
    std::vector<unsigned> ids(robot.links.size(), 0);
    for (std::size_t i = 1; i < ids.size(); ++i) {
      const Link& link = robot.links[i];
      const Sym3<double>& I = link.inertia.rotational;
      const Mat3<double>& turn = link.placement.R;
      const Vec3<double>&p = link.placement.p, &c = link.inertia.com;
      Matrix3d inertia, E;
      inertia << I.xx, I.xy, I.xz, I.xy, I.yy, I.yz, I.xz, I.yz, I.zz;
      for (int r = 0; r < 3; ++r)
        for (int k = 0; k < 3; ++k) E(r, k) = turn(k, r);
      const R::Body body(link.inertia.mass, Vector3d(c.x, c.y, c.z), inertia);
      const R::Joint joint = link.motion == Motion::floating   ? R::Joint(R::JointTypeFloatingBase)
                             : link.motion == Motion::revolute ? R::Joint(R::JointTypeRevolute, Vector3d(0, 0, 1))
                                                               : R::Joint(R::JointTypePrismatic, Vector3d(0, 0, 1));
      ids[i] = model_.AddBody(ids[static_cast<std::size_t>(link.parent)], R::Math::SpatialTransform(E, Vector3d(p.x, p.y, p.z)), joint, body);
    }
    q_ = VectorNd::Zero(model_.q_size);
    v_ = a_ = tau_ = VectorNd::Zero(model_.qdot_size);
    M_ = MatrixNd::Zero(model_.qdot_size, model_.qdot_size);
  }
  bool can(Task task) const override { return isBasic(task); }
  void run(Task task, const State& s) override {
    const Eigen::Index first = floating_ ? 6 : 0;
    if (floating_) {  // RBDL's order is position, (x, y, z) of the quaternion, joints, and w at the very end
      std::copy_n(s.base_q, 6, q_.data());
      q_[q_.size() - 1] = s.base_q[6];
      std::copy_n(s.base_v, 6, v_.data());
      std::copy_n(s.base_a, 6, a_.data());
    }
    std::copy(s.q.begin(), s.q.end(), q_.data() + first);
    if (task == Task::crba) return R::CompositeRigidBodyAlgorithm(model_, q_, M_);
    std::copy(s.v.begin(), s.v.end(), v_.data() + first);
    std::copy(s.a.begin(), s.a.end(), a_.data() + first);
    if (task == Task::rnea) {
      R::InverseDynamics(model_, q_, v_, a_, tau_);
    } else {
      R::ForwardDynamics(model_, q_, v_, a_, tau_);
    }
  }
  std::vector<double> result(Task task) const override {
    const Eigen::Index n = v_.size() - (floating_ ? 6 : 0);
    const Eigen::MatrixXd x = task == Task::crba ? Eigen::MatrixXd(M_.bottomRightCorner(n, n)) : Eigen::MatrixXd(tau_.tail(n));
    return {x.data(), x.data() + x.size()};
  }

 private:
  R::Model model_;
  bool floating_;
  VectorNd q_, v_, a_, tau_;
  MatrixNd M_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Rbdl(robot); }
