// SPDX-License-Identifier: BSD-2-Clause
// Functions on configurations: q (+) v, q1 (-) q0 and their derivatives.
#include "evaluation.hpp"
#include "typed.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/algorithm/states.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using States = Typed<py::object, "ArrayLike">;  ///< one state, or a state a row
using Result = Typed<py::object, "NDArray[float64]">;

/// Calls a function for one state or for each row: function(argument, result), a state a column. A vector counts for all rows.
template <class Function>
Result inStates(const char* name, const std::vector<ArgumentShape>& inputs, int size, const py::args& arguments, const Function& function) {
  const std::vector<ArgumentShape> output{{"", size}};
  Evaluation<double> evaluation(name, inputs, output, arguments);
  {
    const py::gil_scoped_release unlocked;
    function([&](std::size_t k) { return evaluation.view(k); }, MatrixOut(evaluation.output(0, 0), size, evaluation.states()));
  }
  return evaluation.results();
}

}  // namespace

void addConfiguration(py::module_& m) {
  const py::arg model("model"), q("q"), v("v"), q0("q0"), q1("q1");
  py::enum_<ArgumentPosition>(m, "ArgumentPosition", "The argument by which a derivative is taken.")
      .value("ARG0", ArgumentPosition::ARG0)
      .value("ARG1", ArgumentPosition::ARG1);
  m.def(
      "neutral", [](const CompactModel& x) { return neutral(x); }, model, "Returns the configuration at which every joint is at its zero (nq,).");
  m.def(
      "integrate",
      [](const CompactModel& x, const States& a, const States& b) {
        return inStates("integrate", {{"q", x.nq()}, {"v", x.nv()}}, x.nq(), py::make_tuple(a, b),
                        [&x](const auto& in, const MatrixOut& out) { detail::integrateStates(x, in(0), in(1), out); });
      },
      model, q, v,
      "Returns q (+) v (nq,), the configuration that q reaches in unit time at constant joint velocity v. Either may have a state a row.");
  m.def(
      "difference",
      [](const CompactModel& x, const States& a, const States& b) {
        return inStates("difference", {{"q0", x.nq()}, {"q1", x.nq()}}, x.nv(), py::make_tuple(a, b),
                        [&x](const auto& in, const MatrixOut& out) { detail::differenceStates(x, in(0), in(1), out); });
      },
      model, q0, q1, "Returns the v (nv,) for which q0 (+) v = q1. Either may have a state a row.");
  m.def(
      "interpolate",
      [](const CompactModel& x, const States& a, const States& b, const States& t) {
        const py::module_ numpy = py::module_::import("numpy");
        const bool one = py::cast<int>(numpy.attr("ndim")(t)) == 0;
        const py::object times = numpy.attr("reshape")(t, one ? py::make_tuple(1) : py::make_tuple(-1, 1));
        return inStates("interpolate", {{"q0", x.nq()}, {"q1", x.nq()}, {"t", 1}}, x.nq(), py::make_tuple(a, b, times),
                        [&x](const auto& in, const MatrixOut& out) { detail::interpolateStates(x, in(0), in(1), in(2), out); });
      },
      model, q0, q1, py::arg("t"),
      "Returns q0 (+) t (q1 (-) q0) (nq,). Each argument may have a state a row, so that `t` (states,) gives a path from q0 to q1 (states, nq).");
  m.def(
      "distance", [](const CompactModel& x, const Vector& a, const Vector& b) { return distance(x, a, b); }, model, q0, q1,
      "Returns the norm of the difference. Metres and radians count alike.");
  m.def(
      "normalize",
      [](const CompactModel& x, const States& a) {
        return inStates("normalize", {{"q", x.nq()}}, x.nq(), py::make_tuple(a),
                        [&x](const auto& in, const MatrixOut& out) { detail::normalizeStates(x, in(0), out); });
      },
      model, q, "Returns q (nq,) with its quaternions and (cos, sin) pairs scaled to norm one. It may have a state a row.");
  m.def(
      "is_normalized", [](const CompactModel& x, const Vector& a, double tolerance) { return isNormalized(x, a, tolerance); }, model, q,
      py::arg("tolerance") = 1e-12, "Returns whether every quaternion and pair has norm one to within the tolerance.");
  m.def(
      "random_configuration",
      [](const CompactModel& x, std::uint64_t seed, std::optional<py::ssize_t> states) {
        if (states && *states < 0)
          throw Error(ErrorCode::argument, "random_configuration: states is " + std::to_string(*states) + "; give 0 or more");
        py::array_t<double> out(states ? std::vector<py::ssize_t>{*states, x.nq()} : std::vector<py::ssize_t>{x.nq()});
        states::randomConfiguration(x, seed, MatrixOut(out.mutable_data(), x.nq(), states.value_or(1)));
        return out;
      },
      model, py::arg("seed"), py::arg("states") = py::none(),
      "Returns a random configuration (nq,) within the limits. The same seed gives the same configuration. With `states` it returns (states, nq); "
      "row "
      "k has the seed seed + k.");
  m.def(
      "d_integrate", [](const CompactModel& x, const Vector& a, const Vector& b, ArgumentPosition by) { return dIntegrate(x, a, b, by); }, model, q,
      v, py::arg("by"), "Returns the derivative of integrate by q (ARG0) or v (ARG1), (nv, nv), in tangent vectors.");
  m.def(
      "d_difference", [](const CompactModel& x, const Vector& a, const Vector& b, ArgumentPosition by) { return dDifference(x, a, b, by); }, model,
      q0, q1, py::arg("by"), "Returns the derivative of difference by q0 (ARG0) or q1 (ARG1), (nv, nv), in tangent vectors.");
}

}  // namespace dyn::python
