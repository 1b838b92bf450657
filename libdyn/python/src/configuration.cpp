// SPDX-License-Identifier: BSD-2-Clause
// Functions on configurations: q (+) v, q1 (-) q0 and their derivatives.
#include "module.hpp"

#include <dyn/algorithm/configuration.hpp>

#include <pybind11/eigen.h>

namespace dyn::python {

namespace {
using Vector = Eigen::Ref<const Eigen::VectorXd>;
}

void addConfiguration(py::module_& m) {
  const py::arg model("model"), q("q"), v("v"), q0("q0"), q1("q1");
  py::enum_<ArgumentPosition>(m, "ArgumentPosition", "The argument by which a derivative is taken.")
      .value("ARG0", ArgumentPosition::ARG0)
      .value("ARG1", ArgumentPosition::ARG1);
  m.def(
      "neutral", [](const CompactModel& x) { return neutral(x); }, model, "Returns the configuration at which every joint is at its zero (nq,).");
  m.def(
      "integrate", [](const CompactModel& x, const Vector& a, const Vector& b) { return integrate(x, a, b); }, model, q, v,
      "Returns q (+) v (nq,), the configuration that q reaches in unit time at constant joint velocity v.");
  m.def(
      "difference", [](const CompactModel& x, const Vector& a, const Vector& b) { return difference(x, a, b); }, model, q0, q1,
      "Returns the v (nv,) for which q0 (+) v = q1.");
  m.def(
      "interpolate", [](const CompactModel& x, const Vector& a, const Vector& b, double t) { return interpolate(x, a, b, t); }, model, q0, q1,
      py::arg("t"), "Returns q0 (+) t (q1 (-) q0) (nq,).");
  m.def(
      "distance", [](const CompactModel& x, const Vector& a, const Vector& b) { return distance(x, a, b); }, model, q0, q1,
      "Returns the norm of the difference. Metres and radians count alike.");
  m.def(
      "normalize", [](const CompactModel& x, const Vector& a) { return normalize(x, a); }, model, q,
      "Returns q (nq,) with its quaternions and (cos, sin) pairs scaled to norm one.");
  m.def(
      "is_normalized", [](const CompactModel& x, const Vector& a, double tolerance) { return isNormalized(x, a, tolerance); }, model, q,
      py::arg("tolerance") = 1e-12, "Returns whether every quaternion and pair has norm one to within the tolerance.");
  m.def(
      "random_configuration", [](const CompactModel& x, std::uint64_t seed) { return randomConfiguration(x, seed); }, model, py::arg("seed"),
      "Returns a random configuration (nq,) within the limits. The same seed gives the same configuration.");
  m.def(
      "d_integrate", [](const CompactModel& x, const Vector& a, const Vector& b, ArgumentPosition by) { return dIntegrate(x, a, b, by); }, model, q,
      v, py::arg("by"), "Returns the derivative of integrate by q (ARG0) or v (ARG1), (nv, nv), in tangent vectors.");
  m.def(
      "d_difference", [](const CompactModel& x, const Vector& a, const Vector& b, ArgumentPosition by) { return dDifference(x, a, b, by); }, model,
      q0, q1, py::arg("by"), "Returns the derivative of difference by q0 (ARG0) or q1 (ARG1), (nv, nv), in tangent vectors.");
}

}  // namespace dyn::python
