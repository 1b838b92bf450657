// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/turning.hpp"
#include "integrate/stepper.hpp"

namespace dyn {

namespace {

class EulerStepper : public CubicStepper {
 public:
  EulerStepper(EquationsOfMotion& equations, bool semi_implicit)
      : CubicStepper(equations), semi_implicit_(semi_implicit), u_(equations.model().nv()) {}

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    accelerationAt(equations_, from);
    u_ = from.a;
    addTurning(equations_.model().impl(), from.v.data(), u_.data());
    to.v = from.v + h * u_;
    u_ = h * (semi_implicit_ ? to.v : from.v);
    chart_.pointInHeldAxes(from.q.data(), u_.data(), to.v.data(), to.q.data());
    to.has_acceleration = false;
    return StepOutcome::taken;
  }

 private:
  bool semi_implicit_;
  Eigen::VectorXd u_;
};

}  // namespace

std::unique_ptr<Stepper> makeEulerStepper(EquationsOfMotion& equations, bool semi_implicit) {
  return std::make_unique<EulerStepper>(equations, semi_implicit);
}

}  // namespace dyn
