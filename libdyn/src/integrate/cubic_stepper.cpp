// SPDX-License-Identifier: BSD-2-Clause
#include "integrate/stepper.hpp"

#include <dyn/algorithm/configuration.hpp>

namespace dyn {

CubicStepper::CubicStepper(EquationsOfMotion& equations)
    : equations_(equations), chart_(equations.model()), u_(equations.model().nv()), rate_(equations.model().nv()) {}

const double* accelerationAt(EquationsOfMotion& equations, Moment& x) {
  if (!x.has_acceleration) {
    x.a = VectorResult(equations.acceleration(x.time, x.q.data(), x.v.data()), equations.model().nv());
    x.has_acceleration = true;
  }
  return x.a.data();
}

void CubicStepper::between(double theta, Moment& from, Moment& to, double* q, double* v) {
  const CompactModel& model = equations_.model();
  accelerationAt(equations_, from);
  accelerationAt(equations_, to);
  detail::difference(model, {from.q.data(), model.nq()}, {to.q.data(), model.nq()}, {u_.data(), model.nv()});
  chart_.rate(from.q.data(), to.q.data(), to.v.data(), rate_.data());
  const double s = theta, end = s * s * (3 - 2 * s), out = h_ * s * (1 - s) * (1 - s), in = h_ * s * s * (s - 1);
  VectorMap(v, model.nv()) = from.v + end * (to.v - from.v) + out * from.a + in * to.a;
  u_ = end * u_ + out * from.v + in * rate_;
  chart_.point(from.q.data(), u_.data(), q);
}

}  // namespace dyn
