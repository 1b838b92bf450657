// SPDX-License-Identifier: BSD-2-Clause
// Memory of algorithms, for one state and for many.
#include "module.hpp"
#include "objects.hpp"
#include "printing.hpp"

namespace dyn::python {

namespace {

// Python programs rarely count bytes, so a Data has memory for all results unless they do.
constexpr Need all_of_a_state = Need::mass_matrix | Need::derivatives;

template <class T>
void addBatch(py::module_& m, const char* name, const char* doc) {
  py::class_<Batch<T>>(m, name, doc)
      .def(py::init<const CompactModel&, int, Need, int>(), py::arg("model"), py::arg("capacity"), py::arg("needs") = all_of_a_state,
           py::arg("threads") = 1)
      .def(
          "set_models",
          [](Batch<T>& b, const std::vector<CompactModel>& models) {
            const InUse use(b.busy, "set_models");
            b.data.setModels(models);
          },
          py::arg("models"),
          "Makes state k that of models[k] in all calls that follow, which take at most as many states as there are models.\n\n"
          "models: made from the batch's own by with_numbers(), with other inertias only. An empty list: all states are of the batch's own model.")
      .def_property_readonly(
          "capacity", [](const Batch<T>& b) { return b.data.capacity(); }, "The largest number of states.")
      .def_property_readonly(
          "threads", [](const Batch<T>& b) { return b.data.threads(); }, "The number of threads, the caller's included.")
      .def_property_readonly(
          "lanes", [](const Batch<T>& b) { return b.data.lanes(); }, "The number of states that one instruction computes.")
      .def("__reduce__", &refusePickle<Batch<T>>)
      .def("__repr__",
           [name](const Batch<T>& b) {
             return "<libdyn." + std::string(name) + ": at most " + std::to_string(b.data.capacity()) + " states, " +
                    std::to_string(b.data.threads()) + (b.data.threads() == 1 ? " thread>" : " threads>");
           })
      .def_property_readonly(
          "nbytes", [](const Batch<T>& b) { return b.data.bytes(); }, "The size in bytes.");
}

}  // namespace

void addData(py::module_& m) {
  py::enum_<Need> kinds(m, "Need", py::arithmetic(), "Results that a Data or a BatchData has memory for; combine them by |.");
  kinds.value("STATE", Need::state, "everything of size O(n)")
      .value("MASS_MATRIX", Need::mass_matrix, "M, nv x nv")
      .value("KINEMATICS", Need::kinematics, "of a BatchData only: poses, velocities and accelerations of every body in every state")
      .value("JACOBIANS", Need::jacobians, "of a BatchData only: one 6 x nv matrix a state")
      .value("DERIVATIVES", Need::derivatives, "nv x nv matrices of derivatives; the mass matrix comes with it")
      .def("__or__", [](Need a, Need b) { return a | b; });
  // def() would add an overload to the one that every enumeration has.
  kinds.attr("__repr__") = py::cpp_function(&writtenBits, py::name("__repr__"), py::is_method(kinds));
  py::class_<Data, std::shared_ptr<Data>>(
      m, "Data", "Memory for all results of one state of a model. Use it in one thread at a time. By default it has room for everything.")
      .def(py::init([](const CompactModel& model, Need needs) { return std::shared_ptr<Data>(std::make_shared<DataOfModel>(model, needs)); }),
           py::arg("model"), py::arg("needs") = all_of_a_state)
      .def_property_readonly("model", &modelOf, "The model that the data belong to.")
      .def_property_readonly("nbytes", &Data::bytes, "The size in bytes.")
      .def("__reduce__", &refusePickle<Data>)
      .def("__repr__", [](const Data& x) { return "<libdyn.Data of '" + modelOf(x).name() + "'>"; });
  addBatch<double>(m, "BatchData",
                   "Memory for up to `capacity` states at once, computed in packs and threads. Functions take arrays with a state a row.");
  addBatch<float>(m, "BatchDataFloat", "As BatchData, but computes in float32.");
}

}  // namespace dyn::python
