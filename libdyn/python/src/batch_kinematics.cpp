// SPDX-License-Identifier: BSD-2-Clause
// Poses, motions and Jacobians of frames in many states at once.
#include "arrays.hpp"
#include "names.hpp"
#include "objects.hpp"

#include <dyn/spatial/eigen.hpp>

#include <pybind11/numpy.h>

#include <optional>

namespace dyn::python {

namespace {

/// Reads an argument with a state a row; none is an argument that is not given.
template <class T>
detail::StatesView<T> viewOf(StatesInput<T>& states, const py::object& array, const char* function, const char* name) {
  if (array.is_none()) return {};
  if (!states.read(array.ptr(), function, name)) throw py::error_already_set();
  return states.view();
}

template <class T>
void forward(const CompactModel& model, Batch<T>& batch, const py::object& q, const py::object& v, const py::object& a) {
  constexpr const char* name = "forward_kinematics";
  if (v.is_none() && !a.is_none()) throw Error(ErrorCode::argument, "forward_kinematics: a without v; give v, too");
  StatesInput<T> states[3];
  const auto Q = viewOf(states[0], q, name, "q"), V = viewOf(states[1], v, name, "v"), A = viewOf(states[2], a, name, "a");
  const InUse use(batch.busy, name);
  batch.placed = 0;
  {
    const py::gil_scoped_release unlocked;
    detail::batchKinematics<T>(model, batch.data, Q, V, A);
  }
  batch.placed = static_cast<int>(Q.cols);
}

/// Returns an array with get(frame, state) for each state, as a matrix of `rows` x `columns` numbers.
template <class T, class Get>
py::array_t<T> eachState(Batch<T>& batch, const char* function, int rows, int columns, const Get& get) {
  const InUse use(batch.busy, function);
  std::vector<py::ssize_t> shape = {batch.placed, rows};
  if (columns > 1) shape.push_back(columns);
  py::array_t<T> out(shape);
  T* to = out.mutable_data();
  if (batch.placed == 0) get(0);  // throws: nothing has been computed
  for (int state = 0; state < batch.placed; ++state, to += rows * columns)
    Eigen::Map<Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(to, rows, columns) = get(state);
  return out;
}

template <class T>
py::object jacobians(const char* function, const CompactModel& model, Batch<T>& batch, const py::object& q, detail::Kind kind, int id,
                     ReferenceFrame reference) {
  StatesInput<T> states;
  const auto Q = viewOf(states, q, function, "q");
  const InUse use(batch.busy, function);
  detail::BatchViews<T> views;
  {
    const py::gil_scoped_release unlocked;
    views = detail::batchJacobians<T>(model, batch.data, Q, kind, id, reference);
  }
  PyObject* const out = newArrayOfStates(views.results[0], views.states, 6, model.nv());
  if (out == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(out);
}

/// Centres of mass and their motion in many states.
struct Centers {
  py::object position, velocity, acceleration;
};

template <class T>
py::object arrayOf(const detail::StatesResult<T>& x) {
  if (x.rows() == 0) return py::none();
  PyObject* const out = newArrayOfStates(x.data(), x.cols(), x.rows(), 1);
  if (out == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(out);
}

template <class T>
Centers centers(const CompactModel& model, Batch<T>& batch, const py::object& q, const py::object& v, const py::object& a) {
  constexpr const char* name = "center_of_mass";
  if (v.is_none() && !a.is_none()) throw Error(ErrorCode::argument, "center_of_mass: a without v; give v, too");
  StatesInput<T> states[3];
  const auto Q = viewOf(states[0], q, name, "q"), V = viewOf(states[1], v, name, "v"), A = viewOf(states[2], a, name, "a");
  const InUse use(batch.busy, name);
  const auto found = [&] {
    const py::gil_scoped_release unlocked;
    return detail::batchCentersOfMass<T>(model, batch.data, Q, V, A);
  }();
  return {arrayOf<T>(found.position), arrayOf<T>(found.velocity), arrayOf<T>(found.acceleration)};
}

/// Kinetic energies (result 0), or potential energies (result 1), where v is none.
template <class T>
py::object energies(const char* name, const CompactModel& model, Batch<T>& batch, const py::object& q, const py::object& v, std::size_t result) {
  StatesInput<T> states[2];
  const auto Q = viewOf(states[0], q, name, "q"), V = viewOf(states[1], v, name, "v");
  const InUse use(batch.busy, name);
  const auto found = [&] {
    const py::gil_scoped_release unlocked;
    return detail::runBatch<T>(model, batch.data, Algorithm::energies, Q, V, {});
  }();
  return arrayOf<T>(found(result)).attr("ravel")();
}

template <class T>
void addFor(py::module_& m) {
  const py::arg model("model"), batch("data"), q("q"), joint("joint"), frame("frame");
  const py::arg_v reference("reference", ReferenceFrame::LOCAL, "LOCAL");
  m.def("forward_kinematics", &forward<T>, model, batch, q, py::arg("v") = py::none(), py::arg("a") = py::none(),
        "Computes the poses of all joints in every state (a row of q); the batch must have been made with Need.KINEMATICS.");
  m.def(
      "frame_placement",
      [](const CompactModel& x, Batch<T>& b, const Name& i) {
        const int id = frameOf(x, i);
        return eachState(b, "frame_placement", 4, 4, [&](int state) { return toEigen(framePlacement<T>(x, b.data, id, state)); });
      },
      model, batch, frame, "Returns the poses of a frame in all states, as matrices [[R, p], [0, 1]] (states, 4, 4).");
  m.def(
      "frame_velocity",
      [](const CompactModel& x, Batch<T>& b, const Name& i, ReferenceFrame r) {
        const int id = frameOf(x, i);
        return eachState(b, "frame_velocity", 6, 1, [&](int state) { return toEigen(frameVelocity<T>(x, b.data, id, state, r)); });
      },
      model, batch, frame, reference, "Returns the spatial velocities of a frame in all states (states, 6) [m/s, rad/s].");
  m.def(
      "frame_acceleration",
      [](const CompactModel& x, Batch<T>& b, const Name& i, ReferenceFrame r) {
        const int id = frameOf(x, i);
        return eachState(b, "frame_acceleration", 6, 1, [&](int state) { return toEigen(frameAcceleration<T>(x, b.data, id, state, r)); });
      },
      model, batch, frame, reference, "Returns the spatial accelerations of a frame in all states (states, 6) [m/s^2, rad/s^2], without gravity.");
  m.def(
      "compute_joint_jacobian",
      [](const CompactModel& x, Batch<T>& b, const py::object& at, const Name& i, ReferenceFrame r) {
        return jacobians("compute_joint_jacobian", x, b, at, detail::Kind::joint, jointOf(x, i), r);
      },
      model, batch, q, joint, reference, "Returns the Jacobians of a joint in every state (states, 6, nv); the batch needs Need.JACOBIANS.");
  m.def(
      "compute_frame_jacobian",
      [](const CompactModel& x, Batch<T>& b, const py::object& at, const Name& i, ReferenceFrame r) {
        return jacobians("compute_frame_jacobian", x, b, at, detail::Kind::frame, frameOf(x, i), r);
      },
      model, batch, q, frame, reference, "Returns the Jacobians of a frame in every state (states, 6, nv); the batch needs Need.JACOBIANS.");
  m.def("center_of_mass", &centers<T>, model, batch, q, py::arg("v") = py::none(), py::arg("a") = py::none(),
        "Returns the centres of mass in all states; with v their velocities, too; with a also their accelerations.");
  m.def(
      "compute_kinetic_energy",
      [](const CompactModel& x, Batch<T>& b, const py::object& at, const py::object& along) {
        return energies<T>("compute_kinetic_energy", x, b, at, along, 0);
      },
      model, batch, q, py::arg("v"), "Returns the kinetic energies in all states (states,) [J].");
  m.def(
      "compute_potential_energy",
      [](const CompactModel& x, Batch<T>& b, const py::object& at) { return energies<T>("compute_potential_energy", x, b, at, py::none(), 1); },
      model, batch, q, "Returns the potential energies in all states (states,) [J].");
}

}  // namespace

void addBatchKinematics(py::module_& m) {
  py::class_<Centers>(m, "CentersOfMass", "Centres of mass in many states and their motion, in world axes; a state a row.")
      .def_readonly("position", &Centers::position, "The positions (states, 3) [m].")
      .def_readonly("velocity", &Centers::velocity, "The velocities (states, 3) [m/s]; None unless v was given.")
      .def_readonly("acceleration", &Centers::acceleration, "The accelerations (states, 3) [m/s^2]; None unless a was given.");
  addFor<double>(m);
  addFor<float>(m);
}

}  // namespace dyn::python
