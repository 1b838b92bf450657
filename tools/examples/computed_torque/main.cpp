// SPDX-License-Identifier: BSD-2-Clause
// Computed-torque control of an arm along a sine trajectory, in comparison with PD control with the same gains.
// The program simulates five seconds with each controller and prints the tracking errors after the first second, when the initial error is gone.
// It returns 1 if the error of computed torque is above its bound, or not far below the error of PD control.
#include <dyn/dyn.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

namespace {

struct Reference {
  Eigen::VectorXd q, v, a;
};

// Each joint swings about 0.3 rad with an amplitude of 0.5 rad and a phase of its own.
Reference referenceAt(const dyn::CompactModel& model, double t) {
  const double amplitude = 0.5, frequency = 2.0;  // [rad], [rad/s]
  Eigen::VectorXd offset(model.nv()), v(model.nv()), a(model.nv());
  for (int k = 0; k < model.nv(); ++k) {
    const double phase = frequency * t + 0.7 * k;
    offset[k] = 0.3 + amplitude * std::sin(phase);
    v[k] = amplitude * frequency * std::cos(phase);
    a[k] = -amplitude * frequency * frequency * std::sin(phase);
  }
  return {dyn::integrate(model, dyn::neutral(model), offset), v, a};
}

struct TrackingError {
  double rms = 0, largest = 0;  // [rad], over all joints
};

// Simulates the controller from an initial error of 0.1 rad in each joint, and measures the error from t = 1 s on.
TrackingError simulate(const dyn::CompactModel& model, const dyn::Controller& controller) {
  const double settled = 1, duration = 5;
  dyn::Simulator simulator(model, {.integrator = dyn::Integrator::rk4, .dt = 5e-4});
  const Reference start = referenceAt(model, 0);
  simulator.reset(dyn::integrate(model, start.q, Eigen::VectorXd::Constant(model.nv(), 0.1)), start.v);
  simulator.setController(controller);
  simulator.advance(settled);

  std::vector<double> times;
  for (int i = 0; i <= 400; ++i) times.push_back(settled + (duration - settled) * i / 400);
  TrackingError error;
  double sum = 0;
  simulator.advance(duration, times, [&](double t, dyn::VectorResult q, dyn::VectorResult) {
    const Eigen::VectorXd e = dyn::difference(model, q, referenceAt(model, t).q);
    sum += e.squaredNorm() / model.nv();
    error.largest = std::max(error.largest, e.lpNorm<Eigen::Infinity>());
  });
  error.rms = std::sqrt(sum / static_cast<double>(times.size()));
  return error;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string path = argc > 1 ? argv[1] : "models/arm.urdf";
    const dyn::CompactModel model = dyn::compile(dyn::urdf::load(path), dyn::JointRegistry::standard());
    dyn::Data data(model, dyn::Need::mass_matrix);  // memory of the controllers; the simulator has its own

    // All controllers have the same gains per unit of inertia. PD scales them with the largest inertia of each joint along the trajectory.
    const double kp = 400, kd = 40;  // [1/s^2], [1/s]: critical damping with a time constant of 0.05 s
    Eigen::VectorXd inertia = Eigen::VectorXd::Zero(model.nv());
    for (double t = 0; t < 3.2; t += 0.1) inertia = inertia.cwiseMax(dyn::crba(model, data, referenceAt(model, t).q).diagonal());

    const auto pd = [&](double t, dyn::VectorResult q, dyn::VectorResult v, dyn::VectorMap tau) {
      const Reference r = referenceAt(model, t);
      tau = inertia.cwiseProduct(kp * dyn::difference(model, q, r.q) + kd * (r.v - v));
    };
    const auto pd_with_gravity = [&](double t, dyn::VectorResult q, dyn::VectorResult v, dyn::VectorMap tau) {
      pd(t, q, v, tau);
      tau += dyn::generalizedGravity(model, data, q);
    };
    // Inverse dynamics of the wanted acceleration plus feedback: the error obeys e'' + kd e' + kp e = 0.
    const auto computed_torque = [&](double t, dyn::VectorResult q, dyn::VectorResult v, dyn::VectorMap tau) {
      const Reference r = referenceAt(model, t);
      const Eigen::VectorXd a = r.a + kp * dyn::difference(model, q, r.q) + kd * (r.v - v);
      tau = dyn::rnea(model, data, q, v, a);
    };

    const TrackingError plain = simulate(model, pd), gravity = simulate(model, pd_with_gravity), computed = simulate(model, computed_torque);
    std::printf("%s, %d degrees of freedom, tracking error from 1 s to 5 s:\n", model.name().c_str(), model.nv());
    std::printf("  PD               rms %.2e rad, largest %.2e rad\n", plain.rms, plain.largest);
    std::printf("  PD with gravity  rms %.2e rad, largest %.2e rad\n", gravity.rms, gravity.largest);
    std::printf("  computed torque  rms %.2e rad, largest %.2e rad\n", computed.rms, computed.largest);

    const double bound = 1e-5;  // [rad]
    const bool good = computed.largest < bound && computed.largest < gravity.largest / 10 && computed.largest < plain.largest / 10;
    std::printf("%s: the bound for computed torque is %.0e rad\n", good ? "success" : "FAILURE", bound);
    return good ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
