// SPDX-License-Identifier: BSD-2-Clause
// A floating-base robot stands on its feet: contacts hold the feet, joint torques carry the weight and hold the posture against a push.
// The program simulates one second with and without torques, and prints how far the base moves and which forces act on the feet.
// It returns 1 if the base sinks or tilts, if a foot slides or pulls on the ground, or if the forces do not carry the weight.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

const std::vector<std::string> feet = {"left_foot", "right_foot"};

void setJoint(const dyn::CompactModel& model, VectorXd& q, const std::string& joint, double angle) {
  q[model.joints()[model.jointId(joint)].idx_q] = angle;
}

double height(const dyn::CompactModel& model, dyn::Data& data, const VectorXd& q, const std::string& frame) {
  dyn::forwardKinematics(model, data, q);
  return dyn::framePlacement(model, data, model.frameId(frame)).p.z;
}

struct Result {
  double time = 0;                       // of the end: 1 s, or when the base has sunk by 0.3 m
  double sink = 0, tilt = 0, slide = 0;  // largest sinking [m] and tilt [rad] of the base; motion of a foot until the end [m]
  double least_normal = 1e9;             // smallest vertical force on a foot [N]
  double carried = 0;                    // vertical force on both feet at the end [N]
};

// Simulates one second. The torques are tau_static plus PD control about q0, or zero without `hold`. Stronger motors have larger gains.
// A push of 40 N acts on the base for 0.1 s.
Result simulate(const dyn::CompactModel& model, dyn::ConstraintData& contacts, const VectorXd& q0, const VectorXd& tau_static, bool hold) {
  const double dt = 5e-4, kp = 20, kd = 0.3;  // [s], and gains per unit of effort [1/rad], [s/rad]
  const int base = 1;                         // joint of the floating base, whose six coordinates are the first in v
  const VectorXd effort = VectorXd::Map(model.limits().effort.data(), model.nv());
  dyn::Data data(model);
  Result result;
  VectorXd q = q0, v = VectorXd::Zero(model.nv());
  dyn::ExternalForces push(model.njoints());
  for (int i = 0; i < 2000 && result.sink < 0.3; ++i) {
    VectorXd tau = VectorXd::Zero(model.nv());
    if (hold) {
      tau = tau_static + effort.cwiseProduct(kp * dyn::difference(model, q, q0) - kd * v);
      tau.head<6>().setZero();  // no motor acts on the base
    }
    push[base].linear = i < 200 ? dyn::Vec3<double>{40, 0, 0} : dyn::Vec3<double>{};
    const dyn::ConstrainedMotion motion = dyn::constraintDynamics(model, data, q, v, tau, contacts, push);
    result.carried = 0;
    for (int foot = 0; foot < contacts.set().count(); ++foot) {
      const double normal = motion.lambda[contacts.set().firstRow(foot) + 2];  // along z of the foot, which stands flat
      result.least_normal = std::min(result.least_normal, normal);
      result.carried += normal;
    }
    v += dt * motion.ddq;  // semi-implicit Euler
    q = dyn::integrate(model, q, dt * v);

    result.time = (i + 1) * dt;
    const VectorXd moved = dyn::difference(model, q0, q);
    result.sink = std::max(result.sink, q0[2] - q[2]);
    result.tilt = std::max(result.tilt, moved.segment<3>(3).norm());
  }
  for (const std::string& foot : feet) {
    dyn::forwardKinematics(model, data, q0);
    const dyn::Vec3<double> before = dyn::framePlacement(model, data, model.frameId(foot)).p;
    dyn::forwardKinematics(model, data, q);
    result.slide = std::max(result.slide, dyn::toEigen(dyn::framePlacement(model, data, model.frameId(foot)).p - before).norm());
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string path = argc > 1 ? argv[1] : "models/biped.urdf";
    const dyn::CompactModel model = dyn::compile(dyn::urdf::load(path, {.root = "free_flyer"}), dyn::JointRegistry::standard());
    dyn::Data data(model);

    // The posture has bent knees and flat feet. The base is raised until the feet's frames are at height zero.
    VectorXd q0 = dyn::neutral(model);
    for (const std::string side : {"left", "right"}) {
      setJoint(model, q0, side + "_hip_pitch", -0.4);
      setJoint(model, q0, side + "_knee", 0.8);
      setJoint(model, q0, side + "_ankle_pitch", -0.4);
    }
    q0[2] -= height(model, data, q0, feet[0]);

    // Each foot is held in all six directions. The velocity gain removes what the integration lets the feet drift.
    std::vector<dyn::ConstraintDescription> descriptions;
    for (const std::string& foot : feet) {
      descriptions.push_back(dyn::frameContact(foot));
      descriptions.back().baumgarte.velocity = 50;
    }
    dyn::ConstraintData contacts(dyn::ConstraintSet(model, descriptions));

    // Static torques: the rows of the base in g = tau + J^T lambda give the forces of least norm on the feet, the other rows give tau.
    const VectorXd g = dyn::generalizedGravity(model, data, q0);
    const MatrixXd Jt = dyn::computeConstraintJacobian(model, data, q0, contacts).transpose();
    const VectorXd lambda = Jt.topRows(6).completeOrthogonalDecomposition().solve(g.head(6));
    VectorXd tau = g - Jt * lambda;
    tau.head<6>().setZero();

    const double weight = -model.mass() * model.gravity().z;
    const Result held = simulate(model, contacts, q0, tau, true), limp = simulate(model, contacts, q0, tau, false);
    std::printf("%s, %.1f kg, base %.3f m above the feet, one second with a push of 40 N for 0.1 s\n", model.name().c_str(), model.mass(), q0[2]);
    std::printf("  without torques: the base sinks by %.3f m in %.2f s\n", limp.sink, limp.time);
    std::printf("  with torques:    the base sinks by %.2e m in %.2f s, tilts by %.2e rad, the feet slide by %.1e m\n", held.sink, held.time,
                held.tilt, held.slide);
    std::printf("  forces on the feet: %.2f N at the end, weight %.2f N, smallest on one foot %.1f N\n", held.carried, weight, held.least_normal);
    const bool good = held.sink < 5e-3 && held.tilt < 0.05 && held.slide < 1e-3 && held.least_normal > 0 &&
                      std::abs(held.carried - weight) < 0.01 * weight && limp.sink > 0.1;
    std::printf("%s: the bounds are 5e-03 m and 5e-02 rad for the base, 1e-03 m for the feet\n", good ? "success" : "FAILURE");
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
