// SPDX-License-Identifier: BSD-2-Clause
// Bullet's btMultiBody in double precision: forward dynamics only. (Debian ships Bullet's inverse dynamics library without its headers.)
#include "peers/peers.hpp"

#include <Eigen/Eigenvalues>

#include <BulletDynamics/Featherstone/btMultiBody.h>

namespace dyn::benchmark::peers {

namespace {

btVector3 vector(const Eigen::Vector3d& x) { return {x.x(), x.y(), x.z()}; }
Eigen::Vector3d eigen(const Vec3<double>& x) { return {x.x, x.y, x.z}; }
Eigen::Matrix3d eigen(const Mat3<double>& R) { return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.m); }
btQuaternion quaternion(const Eigen::Matrix3d& R) {
  const Eigen::Quaterniond q(R);
  return {q.x(), q.y(), q.z(), q.w()};
}

/// Bullet expects each link's frame at its centre of mass, along its principal axes.
struct Principal {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d moments = Eigen::Vector3d::Zero(), com = Eigen::Vector3d::Zero();

  Principal() = default;
  explicit Principal(const Inertia<double>& Y) : com(eigen(Y.com)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(eigen(Y.rotational.matrix()));
    R = solver.eigenvectors();
    if (R.determinant() < 0) R.col(0) *= -1;
    moments = solver.eigenvalues();
  }
};

class Bullet : public Peer {
 public:
  explicit Bullet(const Robot& robot)
      : gravity_(vector(eigen(robot.gravity))), principal_(robot.links.size()), acceleration_(static_cast<std::size_t>(robot.joints)) {
    const int base = robot.floating ? 1 : 0;
    for (std::size_t i = 1; i < robot.links.size(); ++i) principal_[i] = Principal(robot.links[i].inertia);
    const Principal& root = principal_[static_cast<std::size_t>(base)];
    base_mass_ = robot.floating ? robot.links[1].inertia.mass : 0;
    body_ = std::make_unique<btMultiBody>(robot.joints, base_mass_, vector(root.moments), !robot.floating, false);
    for (std::size_t i = static_cast<std::size_t>(base) + 1; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      const Principal &mine = principal_[i], &parents = principal_[static_cast<std::size_t>(link.parent)];
      const Eigen::Matrix3d from_parent = (parents.R.transpose() * eigen(link.placement.R) * mine.R).transpose();
      const btVector3 axis = vector(mine.R.transpose() * Eigen::Vector3d::UnitZ()), to_com = vector(mine.R.transpose() * mine.com);
      const btVector3 to_pivot = vector(parents.R.transpose() * (eigen(link.placement.p) - parents.com));
      const int number = static_cast<int>(i) - base - 1, parent = link.parent - base - 1;
      if (link.motion == Motion::revolute) {
        body_->setupRevolute(number, link.inertia.mass, vector(mine.moments), parent, quaternion(from_parent), axis, to_pivot, to_com, true);
      } else {
        body_->setupPrismatic(number, link.inertia.mass, vector(mine.moments), parent, quaternion(from_parent), axis, to_pivot, to_com, true);
      }
    }
    body_->finalizeMultiDof();
    body_->setLinearDamping(0);
    body_->setAngularDamping(0);
    body_->useGlobalVelocities(false);
    body_->setMaxCoordinateVelocity(1e30);
  }
  bool can(Task task) const override { return task == Task::aba; }
  void run(Task, const State& s) override {
    if (base_mass_ > 0) {
      const Principal& root = principal_[1];
      const Eigen::Matrix3d R = Eigen::Quaterniond(s.base_q[6], s.base_q[3], s.base_q[4], s.base_q[5]).toRotationMatrix();
      const Eigen::Vector3d w(s.base_v[3], s.base_v[4], s.base_v[5]), v(s.base_v[0], s.base_v[1], s.base_v[2]);
      body_->setBasePos(vector(Eigen::Vector3d(s.base_q[0], s.base_q[1], s.base_q[2]) + R * root.com));
      body_->setWorldToBaseRot(quaternion((R * root.R).transpose()));
      body_->setBaseVel(vector(R * (v + w.cross(root.com))));
      body_->setBaseOmega(vector(R * w));
    }
    body_->clearForcesAndTorques();
    body_->addBaseForce(base_mass_ * gravity_);
    const int n = body_->getNumLinks();
    for (int k = 0; k < n; ++k) {
      const auto j = static_cast<std::size_t>(k);
      body_->setJointPos(k, s.q[j]);
      body_->setJointVel(k, s.v[j]);
      body_->addJointTorque(k, s.a[j]);
      body_->addLinkForce(k, body_->getLinkMass(k) * gravity_);
    }
    // The function adds dt times the accelerations to the velocities; dt is 1 here.
    body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(1, numbers_, vectors_, matrices_, false, false, false);
    for (int k = 0; k < n; ++k) acceleration_[static_cast<std::size_t>(k)] = body_->getJointVel(k) - s.v[static_cast<std::size_t>(k)];
  }
  std::vector<double> result(Task) const override { return acceleration_; }

  std::vector<std::string> integrators() const override {
    return base_mass_ > 0 ? std::vector<std::string>() : std::vector<std::string>{"semi-implicit Euler"};
  }
  std::vector<double> move(const std::string&, const std::vector<double>& q, double time, int steps) override {
    const int n = body_->getNumLinks();
    for (int k = 0; k < n; ++k) {
      body_->setJointPos(k, q[static_cast<std::size_t>(k)]);
      body_->setJointVel(k, 0);
    }
    for (int step = 0; step < steps; ++step) {
      body_->clearForcesAndTorques();
      for (int k = 0; k < n; ++k) body_->addLinkForce(k, body_->getLinkMass(k) * gravity_);
      body_->computeAccelerationsArticulatedBodyAlgorithmMultiDof(time / steps, numbers_, vectors_, matrices_, false, false, false);
      body_->stepPositionsMultiDof(time / steps);
    }
    std::vector<double> end;
    for (int k = 0; k < n; ++k) end.push_back(body_->getJointPos(k));
    return end;
  }

 private:
  btVector3 gravity_;
  std::vector<Principal> principal_;
  std::vector<double> acceleration_;
  double base_mass_ = 0;
  std::unique_ptr<btMultiBody> body_;
  btAlignedObjectArray<btScalar> numbers_;
  btAlignedObjectArray<btVector3> vectors_;
  btAlignedObjectArray<btMatrix3x3> matrices_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Bullet(robot); }
