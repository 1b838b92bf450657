// SPDX-License-Identifier: BSD-2-Clause
// Iterative LQR: an arm reaches for a point with its last frame, with derivatives of forward dynamics from computeABADerivatives.
// The program prints the cost of each iteration, and the distance from the point at the end of the motion.
// It returns 1 if the last frame misses the point or does not come to rest there.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <Eigen/Cholesky>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

constexpr int knots = 60;
constexpr double dt = 0.02;  // [s]
// Weights of squares: torques beyond those against gravity at the start, velocities, distance from the goal and velocity at the end.
constexpr double weight_torque = 1e-3, weight_velocity = 1e-1, weight_point = 1e4, weight_rest = 30;

using Eigen::MatrixXd, Eigen::VectorXd;

struct Problem {
  const dyn::CompactModel& model;
  dyn::Data& data;
  int frame;
  Eigen::Vector3d goal;
  VectorXd q0, holding;  // first configuration, and the torques that hold it
};

struct Trajectory {
  std::vector<VectorXd> q, v, tau;  // knots + 1, knots + 1, knots
  double cost = 0;
};

// Returns the position of the last frame minus the goal.
Eigen::Vector3d error(const Problem& p, const VectorXd& q) {
  dyn::forwardKinematics(p.model, p.data, q);
  return dyn::toEigen(dyn::framePlacement(p.model, p.data, p.frame).p) - p.goal;
}

// Simulates tau + alpha k + K dx, where dx is the deviation from the trajectory `old`. Without gains it simulates the torques of `old`.
Trajectory rollout(const Problem& p, const Trajectory& old, const std::vector<VectorXd>& k, const std::vector<MatrixXd>& K, double alpha) {
  const int n = p.model.nv();
  Trajectory x;
  x.q.push_back(p.q0);
  x.v.push_back(VectorXd::Zero(n));
  for (int i = 0; i < knots; ++i) {
    VectorXd tau = old.tau[i];
    if (!k.empty()) {
      VectorXd dx(2 * n);
      dx << dyn::difference(p.model, old.q[i], x.q[i]), x.v[i] - old.v[i];
      tau += alpha * k[i] + K[i] * dx;
    }
    x.cost += 0.5 * dt * (weight_torque * (tau - p.holding).squaredNorm() + weight_velocity * x.v[i].squaredNorm());
    x.v.push_back(x.v[i] + dt * dyn::aba(p.model, p.data, x.q[i], x.v[i], tau));  // semi-implicit Euler
    x.q.push_back(dyn::integrate(p.model, x.q[i], dt * x.v[i + 1]));
    x.tau.push_back(tau);
  }
  x.cost += 0.5 * weight_point * error(p, x.q[knots]).squaredNorm() + 0.5 * weight_rest * x.v[knots].squaredNorm();
  return x;
}

// Computes the gains by a Riccati recursion from the last knot to the first. The state is (q, v), with q in its tangent space.
void backward(const Problem& p, const Trajectory& x, double regularization, std::vector<VectorXd>& k, std::vector<MatrixXd>& K) {
  const int n = p.model.nv();
  k.assign(knots, VectorXd());
  K.assign(knots, MatrixXd());
  MatrixXd J(6, n), A(2 * n, 2 * n), B(2 * n, n);
  dyn::computeFrameJacobian(p.model, p.data, x.q[knots], p.frame, dyn::ReferenceFrame::LOCAL_WORLD_ALIGNED, J);
  const MatrixXd Jp = J.topRows(3);
  VectorXd Vx(2 * n);
  MatrixXd Vxx = MatrixXd::Zero(2 * n, 2 * n);
  Vx << weight_point * Jp.transpose() * error(p, x.q[knots]), weight_rest * x.v[knots];
  Vxx.topLeftCorner(n, n) = weight_point * Jp.transpose() * Jp;
  Vxx.bottomRightCorner(n, n) = weight_rest * MatrixXd::Identity(n, n);

  for (int i = knots - 1; i >= 0; --i) {
    // v' = v + dt ddq(q, v, tau) and q' = q (+) dt v', so that dq' = Dq dq + Dv dt dv'.
    const dyn::ABADerivatives d = dyn::computeABADerivatives(p.model, p.data, x.q[i], x.v[i], x.tau[i]);
    const VectorXd step = dt * x.v[i + 1];
    const MatrixXd Dq = dyn::dIntegrate(p.model, x.q[i], step, dyn::ArgumentPosition::ARG0);
    const MatrixXd Dv = dyn::dIntegrate(p.model, x.q[i], step, dyn::ArgumentPosition::ARG1) * dt;
    A.bottomLeftCorner(n, n) = dt * d.ddq_dq;
    A.bottomRightCorner(n, n) = MatrixXd::Identity(n, n) + dt * d.ddq_dv;
    B.bottomRows(n) = dt * d.ddq_dtau;
    A.topRows(n) = Dv * A.bottomRows(n);
    A.topLeftCorner(n, n) += Dq;
    B.topRows(n) = Dv * B.bottomRows(n);

    VectorXd Qx = A.transpose() * Vx;
    Qx.tail(n) += dt * weight_velocity * x.v[i];
    const VectorXd Qu = dt * weight_torque * (x.tau[i] - p.holding) + B.transpose() * Vx;
    const MatrixXd VA = Vxx * A, VB = Vxx * B;
    MatrixXd Qxx = A.transpose() * VA;
    Qxx.bottomRightCorner(n, n) += dt * weight_velocity * MatrixXd::Identity(n, n);
    const MatrixXd Qux = B.transpose() * VA;
    const MatrixXd Quu = B.transpose() * VB + (dt * weight_torque + regularization) * MatrixXd::Identity(n, n);
    const Eigen::LLT<MatrixXd> llt(Quu);
    k[i] = -llt.solve(Qu);
    K[i] = -llt.solve(Qux);
    Vx = Qx + Qux.transpose() * k[i];
    Vxx = Qxx + Qux.transpose() * K[i];
    Vxx = 0.5 * (Vxx + Vxx.transpose().eval());  // removes what rounding adds
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string path = argc > 1 ? argv[1] : "models/arm.urdf";
    const dyn::CompactModel model = dyn::compile(dyn::urdf::load(path), dyn::JointRegistry::standard());
    dyn::Data data(model, dyn::Need::derivatives);
    const VectorXd q0 = dyn::integrate(model, dyn::neutral(model), VectorXd::Constant(model.nv(), 0.3));
    Problem problem{model, data, model.frameId(model.frames().back().name), Eigen::Vector3d::Zero(), q0, dyn::generalizedGravity(model, data, q0)};

    // The goal is where another configuration puts the last frame. The motion may end in any configuration that reaches it.
    problem.goal = error(problem, dyn::integrate(model, q0, VectorXd::Constant(model.nv(), 0.7)));

    Trajectory best;  // begins at rest
    best.tau.assign(knots, problem.holding);
    best = rollout(problem, best, {}, {}, 0);
    std::printf("%s, %d knots, %.3f m from the goal\niteration  0: cost %.6e\n", model.name().c_str(), knots, error(problem, q0).norm(), best.cost);

    std::vector<VectorXd> k;
    std::vector<MatrixXd> K;
    double regularization = 1e-6;
    for (int iteration = 1; iteration <= 40; ++iteration) {
      backward(problem, best, regularization, k, K);
      double alpha = 1;  // of the line search
      Trajectory next = rollout(problem, best, k, K, alpha);
      while (!(next.cost < best.cost) && alpha > 1e-3) next = rollout(problem, best, k, K, alpha /= 2);
      const double gain = best.cost - next.cost;
      if (gain > 0) best = next;
      regularization *= alpha > 0.5 ? 0.2 : 5;
      std::printf("iteration %2d: cost %.6e, step %.3f\n", iteration, best.cost, alpha);
      if (gain > 0 && gain < 1e-6 * best.cost) break;
    }

    const double distance = error(problem, best.q[knots]).norm(), speed = best.v[knots].norm();
    const bool good = distance < 2e-3 && speed < 2e-2;
    std::printf("%s: %.2e m from the goal, bound 2e-03, at %.2e rad/s, bound 2e-02\n", good ? "success" : "FAILURE", distance, speed);
    return good ? 0 : 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 1;
  }
}
