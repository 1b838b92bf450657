// SPDX-License-Identifier: BSD-2-Clause
// Operational-space control (Khatib 1987): the last frame of an arm draws a circle at constant orientation while the null space moves the elbow.
// The program simulates four seconds step by step and prints the errors of the frame and the motion of the posture.
// It returns 1 if the frame leaves the circle, or if the posture does not follow in the null space.
#include <dyn/dyn.hpp>
#include <dyn/lie/so3.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <string>
#include <variant>

int main(int argc, char** argv) {
  try {
    const std::string path = argc > 1 ? argv[1] : "models/arm.urdf";
    const dyn::CompactModel model = dyn::compile(dyn::urdf::load(path), dyn::JointRegistry::standard());
    if (model.nq() != 7 || model.nv() != 7) {
      std::fprintf(stderr, "this example needs an arm with seven joints\n");
      return 2;
    }
    dyn::Data data(model, dyn::Need::derivatives);  // computeMinverse needs it
    const int frame = model.frameId(argc > 2 ? argv[2] : model.frames().back().name);
    const auto reference = dyn::ReferenceFrame::LOCAL_WORLD_ALIGNED;  // origin of the frame, axes of the world

    // The operational-space inertia is that of the frame as if it were held in all six directions, in the axes of the Jacobian.
    dyn::ConstraintDescription hold = dyn::frameContact(model.frames()[frame].name);
    std::get<dyn::FrameConstraint>(hold.relation).axes = dyn::ConstraintAxes::LOCAL_WORLD_ALIGNED;
    dyn::ConstraintData task(dyn::ConstraintSet(model, {hold}));

    const Eigen::VectorXd first{{0, 0.8, 0, -1.0, 0, 0.9, 0}};
    Eigen::VectorXd q = first, v = Eigen::VectorXd::Zero(7);
    dyn::forwardKinematics(model, data, q);
    const dyn::SE3<double> start = dyn::framePlacement(model, data, frame);

    // The wanted posture differs from the first one by 0.6 rad in the third joint. The task allows only a part of this difference.
    Eigen::VectorXd posture = first;
    posture[2] += 0.6;

    const double dt = 1e-3, duration = 4, radius = 0.08, omega = std::numbers::pi;  // [s], [s], [m], [rad/s]
    const double kp = 400, kd = 40, posture_stiffness = 30, posture_damping = 8;    // [1/s^2], [1/s], [N m/rad], [N m s/rad]
    double position_error = 0, rotation_error = 0, null_space_leak = 0;
    const int steps = static_cast<int>(std::lround(duration / dt));
    Eigen::MatrixXd J(6, 7), dJ(6, 7);
    for (int i = 0; i < steps; ++i) {
      // The circle lies in a vertical plane, and its speed grows smoothly over the first second.
      const double t = i * dt, s = std::min(t, 1.0);
      const double angle = omega * (t < 1 ? t * t * t * (1 - t / 2) : t - 0.5);
      const double rate = omega * s * s * (3 - 2 * s), growth = omega * 6 * s * (1 - s);
      const double c = std::cos(angle), n = std::sin(angle);
      const Eigen::Vector3d x = dyn::toEigen(start.p) + radius * Eigen::Vector3d(0, n, 1 - c);
      const Eigen::Vector3d dx = radius * rate * Eigen::Vector3d(0, c, n);
      const Eigen::Vector3d ddx = radius * (growth * Eigen::Vector3d(0, c, n) + rate * rate * Eigen::Vector3d(0, -n, c));

      // Kinematics of the frame, and its errors in world axes.
      dyn::forwardKinematics(model, data, q, v);
      const dyn::SE3<double> pose = dyn::framePlacement(model, data, frame);
      const dyn::Vector6<double> velocity = dyn::toEigen(dyn::frameVelocity(model, data, frame, reference));
      dyn::Vector6<double> e, de = -velocity, acceleration = dyn::Vector6<double>::Zero();
      e << x - dyn::toEigen(pose.p), dyn::toEigen(dyn::log3(start.R * dyn::transpose(pose.R)));
      de.head<3>() += dx;
      acceleration.head<3>() = ddx;
      acceleration += kp * e + kd * de;
      position_error = std::max(position_error, e.head<3>().norm());
      rotation_error = std::max(rotation_error, e.tail<3>().norm());

      // Results of libdyn are views that the next call may overwrite, so the matrices are copied.
      dyn::computeFrameJacobian(model, data, q, frame, reference, J);
      dyn::computeFrameJacobianTimeVariation(model, data, q, v, frame, reference, dJ);
      const Eigen::MatrixXd Minv = dyn::computeMinverse(model, data, q);
      const Eigen::MatrixXd Lambda = dyn::computeOperationalSpaceInertia(model, data, q, task);
      const Eigen::MatrixXd Jbar = Minv * J.transpose() * Lambda;  // dynamically consistent inverse of J
      const Eigen::MatrixXd N = Eigen::MatrixXd::Identity(7, 7) - Jbar * J;

      // tau = J^T F + N^T tau_posture + C v + g
      const dyn::Vector6<double> F = Lambda * (acceleration - dJ * v);
      const Eigen::VectorXd tau_posture = N.transpose() * (posture_stiffness * dyn::difference(model, q, posture) - posture_damping * v);
      const Eigen::VectorXd tau = J.transpose() * F + tau_posture + dyn::nonLinearEffects(model, data, q, v);
      null_space_leak = std::max(null_space_leak, (J * Minv * tau_posture).norm());  // acceleration of the frame by the posture

      // One step of the semi-implicit Euler method.
      v += dt * dyn::aba(model, data, q, v, tau);
      q = dyn::integrate(model, q, dt * v);
    }

    const double moved = q[2] - first[2];
    std::printf("%s, frame %s, %d steps of %.0f ms\n", model.name().c_str(), model.frames()[frame].name.c_str(), steps, 1e3 * dt);
    std::printf("  largest error of the frame: %.2e m, %.2e rad\n", position_error, rotation_error);
    std::printf("  acceleration of the frame by torques of the null space: %.1e m/s^2\n", null_space_leak);
    std::printf("  the third joint moved by %.3f rad in the null space\n", moved);
    const bool good = position_error < 1e-3 && rotation_error < 2e-3 && null_space_leak < 1e-6 && moved > 0.1;
    std::printf("%s: the bounds are 1e-03 m and 2e-03 rad\n", good ? "success" : "FAILURE");
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
