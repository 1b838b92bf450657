#include "algorithm/turning.hpp"
#include "integrate/stepper.hpp"

namespace dyn {

namespace {

class EulerStepper : public CubicStepper {
 public:
  EulerStepper(Law& law, bool semi_implicit) : CubicStepper(law), semi_implicit_(semi_implicit), u_(law.model().nv()) {}

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    accelerationAt(law_, from);
    u_ = from.a;
    addTurning(law_.model().impl(), from.v.data(), u_.data());
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

std::unique_ptr<Stepper> makeEulerStepper(Law& law, bool semi_implicit) { return std::make_unique<EulerStepper>(law, semi_implicit); }

}  // namespace dyn
