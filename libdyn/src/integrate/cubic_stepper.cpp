#include "integrate/stepper.hpp"

#include <dyn/algorithm/configuration.hpp>

namespace dyn {

CubicStepper::CubicStepper(Law& law) : law_(law), chart_(law.model()), u_(law.model().nv()), rate_(law.model().nv()) {}

const double* accelerationAt(Law& law, Moment& x) {
  if (!x.has_acceleration) {
    x.a = VectorResult(law.acceleration(x.time, x.q.data(), x.v.data()), law.model().nv());
    x.has_acceleration = true;
  }
  return x.a.data();
}

void CubicStepper::between(double theta, Moment& from, Moment& to, double* q, double* v) {
  const CompactModel& model = law_.model();
  accelerationAt(law_, from);
  accelerationAt(law_, to);
  detail::difference(model, {from.q.data(), model.nq()}, {to.q.data(), model.nq()}, {u_.data(), model.nv()});
  chart_.rate(from.q.data(), to.q.data(), to.v.data(), rate_.data());
  const double s = theta, end = s * s * (3 - 2 * s), out = h_ * s * (1 - s) * (1 - s), in = h_ * s * s * (s - 1);
  VectorMap(v, model.nv()) = from.v + end * (to.v - from.v) + out * from.a + in * to.a;
  u_ = end * u_ + out * from.v + in * rate_;
  chart_.point(from.q.data(), u_.data(), q);
}

}  // namespace dyn
