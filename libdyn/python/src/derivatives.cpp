// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of kinematics and of constrained dynamics, second derivatives, regressors, and factors of the mass matrix. Results are new arrays.
#include "arrays.hpp"
#include "names.hpp"
#include "objects.hpp"

#include <dyn/algorithm/centroidal.hpp>
#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/kinematics_derivatives.hpp>
#include <dyn/algorithm/regressor.hpp>
#include <dyn/algorithm/second_derivatives.hpp>
#include <dyn/constraint/derivatives.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using Matrix = Eigen::MatrixXd;

/// Returns an array (n, n, n) whose entry [k, i, j] is entry (i, j) of matrix k.
py::array_t<double> arrayOf(const TensorResult& x) {
  const auto n = static_cast<py::ssize_t>(x.n);
  return py::array_t<double>({n, n, n}, {8 * n * n, py::ssize_t{8}, 8 * n}, x.data);
}

void addKinematicsDerivatives(py::module_& m) {
  const py::arg model("model"), data("data"), joint("joint"), frame("frame");
  const py::arg_v reference("reference", ReferenceFrame::LOCAL, "LOCAL");
  m.def(
      "compute_forward_kinematics_derivatives",
      [](const CompactModel& x, Data& d, const Vector& q, const Vector& v, const Vector& a) { computeForwardKinematicsDerivatives(x, d, q, v, a); },
      model, data, py::arg("q"), py::arg("v"), py::arg("a"), "Runs forward_kinematics and prepares the derivatives that get_..._derivatives return.");
  // Adds a function of a joint or frame that returns one matrix (6, nv) for each index.
  const auto add = [&]<std::size_t... k>(std::index_sequence<k...>, const char* name, auto get, auto number, const py::arg& which, const char* doc) {
    m.def(
        name,
        [get, number](const CompactModel& x, Data& d, const Name& i, ReferenceFrame r) {
          Matrix out[] = {((void)k, Matrix(6, x.nv()))...};
          get(x, d, number(x, i), r, out[k]...);
          return std::make_tuple(std::move(out[k])...);
        },
        model, data, which, reference, doc);
  };
  constexpr std::make_index_sequence<2> of_velocity;
  const char* const velocity = "Returns the derivatives (6, nv) of the velocity by q and v.";
  add(
      of_velocity, "get_joint_velocity_derivatives", [](auto&&... x) { getJointVelocityDerivatives(x...); }, &jointOf, joint, velocity);
  add(
      of_velocity, "get_frame_velocity_derivatives", [](auto&&... x) { getFrameVelocityDerivatives(x...); }, &frameOf, frame, velocity);
  constexpr std::make_index_sequence<4> of_acceleration;
  const char* const acceleration = "Returns the derivative (6, nv) of the velocity by q, and those of the acceleration by q, v and a.";
  add(
      of_acceleration, "get_joint_acceleration_derivatives", [](auto&&... x) { getJointAccelerationDerivatives(x...); }, &jointOf, joint,
      acceleration);
  add(
      of_acceleration, "get_frame_acceleration_derivatives", [](auto&&... x) { getFrameAccelerationDerivatives(x...); }, &frameOf, frame,
      acceleration);
}

void addRegressors(py::module_& m) {
  const py::arg model("model"), data("data"), q("q"), v("v");
  m.def(
      "body_regressor", [](const Motion<double>& v_body, const Motion<double>& a_body) { return bodyRegressor(v_body, a_body); }, py::arg("velocity"),
      py::arg("acceleration"), "Returns Y (6, 10): Y pi is the force on a body with the ten parameters pi.");
  m.def(
      "compute_joint_torque_regressor",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& a) {
        return Matrix(computeJointTorqueRegressor(x, d, at, w, a));
      },
      model, data, q, v, py::arg("a"), "Returns Y (nv, 10 (njoints - 1)): Y pi is rnea without armature and dissipation.");
  m.def(
      "compute_kinetic_energy_regressor",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w) { return Eigen::VectorXd(computeKineticEnergyRegressor(x, d, at, w)); },
      model, data, q, v, "Returns y (10 (njoints - 1),): y . pi is the kinetic energy [J], without armature.");
  m.def(
      "compute_potential_energy_regressor",
      [](const CompactModel& x, Data& d, const Vector& at) { return Eigen::VectorXd(computePotentialEnergyRegressor(x, d, at)); }, model, data, q,
      "Returns y (10 (njoints - 1),): y . pi is the potential energy [J].");
  m.def(
      "dynamic_parameters", [](const CompactModel& x) { return dynamicParameters(x); }, model,
      "Returns pi (10 (njoints - 1),): the ten parameters (m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of each joint's body, in the joint's frame.");
}

template <class T>
void addBatchFactors(py::module_& c) {
  const py::arg model("model"), data("data");
  c.def(
      "decompose",
      [](const CompactModel& k, Batch<T>& b, const py::object& q) {
        constexpr const char* name = "decompose";
        StatesInput<T> states;
        if (!states.read(q.ptr(), name, "q")) throw py::error_already_set();
        const InUse use(b.busy, name);
        const py::gil_scoped_release unlocked;
        detail::batchFactors<T>(k, b.data, states.view());
      },
      model, data, py::arg("q"), "Computes factors of M^-1 in all states (a row of q); the batch needs Need.DERIVATIVES.");
  c.def(
      "solve",
      [](const CompactModel& k, Batch<T>& b, const py::object& x) {
        constexpr const char* name = "solve";
        StatesInput<T> states;
        if (!states.read(x.ptr(), name, "x")) throw py::error_already_set();
        const InUse use(b.busy, name);
        const auto found = [&] {
          const py::gil_scoped_release unlocked;
          return detail::batchSolve<T>(k, b.data, states.view());
        }();
        PyObject* const out = newArrayOfStates(found.results[0], found.states, found.rows[0], 1);
        if (out == nullptr) throw py::error_already_set();
        return py::reinterpret_steal<py::object>(out);
      },
      model, data, py::arg("x"), "Returns M^-1 x for a row of x for each state of the last decompose().");
}

void addFactors(py::module_& m) {
  auto c = m.def_submodule("cholesky", "Tree-sparse factors of M = U D U^T, of the M of the last crba().");
  const py::arg model("model"), data("data"), x("x");
  c.def(
      "decompose", [](const CompactModel& k, Data& d) { cholesky::decompose(k, d); }, model, data, "Computes the factors.");
  addBatchFactors<double>(c);
  addBatchFactors<float>(c);
  const auto product = [&](const char* name, auto apply, const char* doc) {
    c.def(
        name,
        [apply](const CompactModel& k, Data& d, const Vector& given) {
          Eigen::VectorXd out = given;
          apply(k, d, out);
          return out;
        },
        model, data, x, doc);
    c.def(
        name,
        [apply](const CompactModel& k, Data& d, const Eigen::Ref<const Matrix>& given) {
          Matrix out = given;
          apply(k, d, out);
          return out;
        },
        model, data, x);
  };
  product(
      "solve", [](auto&... k) { cholesky::solve(k...); }, "Returns M^-1 x, for a vector or the columns of a matrix.");
  product(
      "Mv", [](auto&... k) { cholesky::Mv(k...); }, "Returns M x.");
  product(
      "Uv", [](auto&... k) { cholesky::Uv(k...); }, "Returns U x.");
  product(
      "Utv", [](auto&... k) { cholesky::Utv(k...); }, "Returns U^T x.");
  m.def(
      "condition_of_mass_matrix", [](const CompactModel& k, Data& d) { return conditionOfMassMatrix(k, d); }, model, data,
      "Estimates the condition number of the M of the last crba(), with the factors of the last decompose().");
  m.def(
      "forward_dynamics",
      [](const CompactModel& k, Data& d, const Vector& q, const Vector& v, const Vector& tau) {
        return Eigen::VectorXd(forwardDynamics(k, d, q, v, tau));
      },
      model, data, py::arg("q"), py::arg("v"), py::arg("tau"), "Computes ddq (nv,) through crba and the factors of M. aba is faster and more exact.");
}

}  // namespace

void addDerivatives(py::module_& m) {
  addKinematicsDerivatives(m);
  addRegressors(m);
  addFactors(m);
  const py::arg model("model"), data("data"), q("q"), v("v"), constraints("constraints");
  m.def(
      "compute_generalized_gravity_derivatives",
      [](const CompactModel& x, Data& d, const Vector& at) { return Matrix(computeGeneralizedGravityDerivatives(x, d, at)); }, model, data, q,
      "Returns the derivative (nv, nv) of generalized_gravity by q, in tangent vectors.");
  m.def(
      "compute_center_of_mass_derivatives",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& a) {
        const CenterOfMassDerivatives r = computeCenterOfMassDerivatives(x, d, at, w, a);
        return py::make_tuple(Matrix(r.vcom_dq), Matrix(r.acom_dq), Matrix(r.acom_dv));
      },
      model, data, q, v, py::arg("a"),
      "Returns the derivatives (3, nv) of the velocity of the centre of mass by q, and of its acceleration by q and v, in world axes.");
  m.def(
      "compute_rnea_second_order_derivatives",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& a) {
        SecondDerivativeData second(x);
        const RneaSecondDerivatives r = computeRNEASecondOrderDerivatives(x, d, second, at, w, a);
        return std::make_tuple(arrayOf(r.d2tau_dqdq), arrayOf(r.d2tau_dqdv), arrayOf(r.d2tau_dvdv), arrayOf(r.d2tau_dadq));
      },
      model, data, q, v, py::arg("a"),
      "Returns d2tau_dqdq, d2tau_dqdv, d2tau_dvdv and d2tau_dadq, each (nv, nv, nv): [k] is the change along degree of freedom k.");
  m.def(
      "compute_constraint_dynamics_derivatives",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& tau, ConstraintData& c) {
        const ConstraintDynamicsDerivatives r = computeConstraintDynamicsDerivatives(x, d, at, w, tau, c);
        return std::make_tuple(Matrix(r.ddq_dq), Matrix(r.ddq_dv), Matrix(r.ddq_dtau), Matrix(r.lambda_dq), Matrix(r.lambda_dv),
                               Matrix(r.lambda_dtau));
      },
      model, data, q, v, py::arg("tau"), constraints,
      "Returns the derivatives of accelerations (nv, nv), then of constraint forces (rows, nv), by q, v and tau.");
  m.def(
      "compute_impulse_dynamics_derivatives",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, double restitution, ConstraintData& c) {
        const ImpulseDynamicsDerivatives r = computeImpulseDynamicsDerivatives(x, d, at, w, restitution, c);
        return std::make_tuple(Matrix(r.v_after_dq), Matrix(r.v_after_dv), Matrix(r.impulse_dq), Matrix(r.impulse_dv));
      },
      model, data, q, v, py::arg("restitution"), constraints,
      "Returns the derivatives of velocities after an impact (nv, nv), then of impulses (rows, nv), by q and v.");
}

}  // namespace dyn::python
