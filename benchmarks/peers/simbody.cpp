// SPDX-License-Identifier: BSD-2-Clause
// Simbody: calls Simbody's operators without constraints.
#include "peers/peers.hpp"

#include <Simbody.h>

#include <memory>

namespace dyn::benchmark::peers {

namespace {

SimTK::Vec3 vector(const Vec3<double>& x) { return {x.x, x.y, x.z}; }

class Simbody : public Peer {
 public:
  explicit Simbody(const Robot& robot)
      : matter_(system_), forces_(system_), gravity_(forces_, matter_, vector(robot.gravity)), floating_(robot.floating) {
    std::vector<SimTK::MobilizedBody> bodies{matter_.Ground()};
    for (std::size_t i = 1; i < robot.links.size(); ++i) {
      const Link& link = robot.links[i];
      const Mat3<double>& R = link.placement.R;
      const SimTK::Mat33 turn(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2));
      const SimTK::Transform placement(SimTK::Rotation(turn, true), vector(link.placement.p));
      const Sym3<double> I = link.inertia.rotationalAtOrigin();
      const SimTK::Body::Rigid body(
          SimTK::MassProperties(link.inertia.mass, vector(link.inertia.com), SimTK::Inertia(I.xx, I.yy, I.zz, I.xy, I.xz, I.yz)));
      SimTK::MobilizedBody& parent = bodies[static_cast<std::size_t>(link.parent)];
      // Simbody's slider joints move along x.
      const SimTK::Transform z_is_x(SimTK::Rotation(-SimTK::Pi / 2, SimTK::YAxis));
      if (link.motion == Motion::floating) bodies.push_back(SimTK::MobilizedBody::Free(parent, placement, body, SimTK::Transform()));
      if (link.motion == Motion::revolute) bodies.push_back(SimTK::MobilizedBody::Pin(parent, placement, body, SimTK::Transform()));
      if (link.motion == Motion::prismatic) bodies.push_back(SimTK::MobilizedBody::Slider(parent, placement * z_is_x, body, z_is_x));
    }
    state_ = system_.realizeTopology();
    system_.realizeModel(state_);
    n_ = state_.getNU();
    acceleration_.resize(n_);
    tau_.resize(n_);
    torque_.resize(n_);
  }
  bool can(Task task) const override { return isBasic(task); }
  void run(Task task, const State& s) override {
    const int nq = floating_ ? 7 : 0, nu = floating_ ? 6 : 0;
    SimTK::Vector &q = state_.updQ(), &u = state_.updU();
    if (floating_) {  // Simbody's order is (w, x, y, z), then the position; velocities are in world axes, angular first
      const SimTK::Rotation R(SimTK::Quaternion(SimTK::Vec4(s.base_q[6], s.base_q[3], s.base_q[4], s.base_q[5])));
      q[0] = s.base_q[6];
      for (int k = 0; k < 3; ++k) {
        q[1 + k] = s.base_q[3 + k];
        q[4 + k] = s.base_q[k];
      }
      const SimTK::Vec3 v = R * SimTK::Vec3(s.base_v[0], s.base_v[1], s.base_v[2]), w = R * SimTK::Vec3(s.base_v[3], s.base_v[4], s.base_v[5]);
      for (int k = 0; k < 3; ++k) {
        u[k] = w[k];
        u[3 + k] = v[k];
      }
    }
    for (std::size_t k = 0; k < s.q.size(); ++k) q[nq + static_cast<int>(k)] = s.q[k];
    if (task == Task::crba) {
      system_.realize(state_, SimTK::Stage::Position);
      matter_.calcM(state_, M_);
      return;
    }
    for (std::size_t k = 0; k < s.v.size(); ++k) u[nu + static_cast<int>(k)] = s.v[k];
    for (int k = 0; k < n_; ++k) torque_[k] = k < nu ? s.base_a[k] : s.a[static_cast<std::size_t>(k - nu)];
    system_.realize(state_, SimTK::Stage::Dynamics);
    const SimTK::Vector_<SimTK::SpatialVec>& weights = system_.getRigidBodyForces(state_, SimTK::Stage::Dynamics);
    if (task == Task::rnea) {
      matter_.calcResidualForceIgnoringConstraints(state_, SimTK::Vector(n_, 0.0), weights, torque_, tau_);
    } else {
      matter_.calcAccelerationIgnoringConstraints(state_, torque_, weights, acceleration_, body_accelerations_);
    }
  }
  std::vector<double> result(Task task) const override {
    const int first = floating_ ? 6 : 0;
    std::vector<double> out;
    for (int i = first; i < n_; ++i) {
      if (task != Task::crba) out.push_back(task == Task::rnea ? tau_[i] : acceleration_[i]);
      for (int j = first; j < n_ && task == Task::crba; ++j) out.push_back(M_(i, j));
    }
    return out;
  }

  std::vector<std::string> integrators() const override {
    return floating_ ? std::vector<std::string>() : std::vector<std::string>{"semi-explicit Euler", "Verlet", "Runge-Kutta-Merson"};
  }
  std::vector<double> move(const std::string& integrator, const std::vector<double>& q, double time, int steps) override {
    std::unique_ptr<SimTK::Integrator> method;
    if (integrator == "Verlet") {
      method = std::make_unique<SimTK::VerletIntegrator>(system_);
    } else if (integrator == "Runge-Kutta-Merson") {
      method = std::make_unique<SimTK::RungeKuttaMersonIntegrator>(system_);
    } else {
      method = std::make_unique<SimTK::SemiExplicitEulerIntegrator>(system_, time / steps);
    }
    if (integrator != "semi-explicit Euler") method->setFixedStepSize(time / steps);
    SimTK::State start = system_.getDefaultState();
    system_.realizeModel(start);
    for (std::size_t k = 0; k < q.size(); ++k) start.updQ()[static_cast<int>(k)] = q[k];
    start.updU() = 0;
    method->initialize(start);
    while (method->getTime() < time) method->stepTo(time, time);
    const SimTK::Vector& end = method->getState().getQ();
    return {&end[0], &end[0] + end.size()};
  }

 private:
  SimTK::MultibodySystem system_;
  SimTK::SimbodyMatterSubsystem matter_;
  SimTK::GeneralForceSubsystem forces_;
  SimTK::Force::UniformGravity gravity_;
  bool floating_;
  SimTK::State state_;
  int n_ = 0;
  SimTK::Vector acceleration_, tau_, torque_;
  SimTK::Vector_<SimTK::SpatialVec> body_accelerations_;
  SimTK::Matrix M_;
};

}  // namespace

}  // namespace dyn::benchmark::peers

dyn::benchmark::peers::Peer* makePeer(const dyn::benchmark::peers::Robot& robot) { return new dyn::benchmark::peers::Simbody(robot); }
