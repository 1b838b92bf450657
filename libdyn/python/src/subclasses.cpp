// SPDX-License-Identifier: BSD-2-Clause
// Spatial quantities as instances of classes that Python derives from ours; the class from which pybind11 derives all.
#include "module.hpp"

#include <dyn/spatial/inertia.hpp>

namespace dyn::python {

namespace {

/// Makes an instance of `cls` with a copy of x. Its __init__ is not called, which saves most of the time.
template <class T>
py::object as(const py::type& cls, const T& x) {
  auto* type = reinterpret_cast<PyTypeObject*>(cls.ptr());
  py::detail::type_info* registered = py::detail::get_type_info(typeid(T));
  if (!PyType_IsSubtype(type, registered->type)) throw py::type_error("_as: cls must be derived from the class of x");
  py::object out = py::reinterpret_steal<py::object>(py::detail::make_new_instance(type));
  auto* instance = reinterpret_cast<py::detail::instance*>(out.ptr());
  instance->owned = true;
  instance->get_value_and_holder().value_ptr() = new T(x);
  registered->init_instance(instance, nullptr);
  return out;
}

/// Makes an object of a pybind11 class, but of no class that pybind11 does not know. pybind11's own function throws there, and so ends the process:
/// pickle's protocols 0 and 1 make an object of the common base class.
newfunc make = nullptr;
PyObject* makeIfKnown(PyTypeObject* type, PyObject* arguments, PyObject* keywords) {
  if (py::detail::all_type_info(type).empty()) {
    PyErr_Format(PyExc_TypeError, "objects of %s can neither be made nor pickled", type->tp_name);
    return nullptr;
  }
  return make(type, arguments, keywords);
}

}  // namespace

void addSubclasses(py::module_& m) {
  auto* base = reinterpret_cast<PyTypeObject*>(py::detail::get_internals().instance_base);
  if (base->tp_new != makeIfKnown) {
    make = base->tp_new;
    base->tp_new = makeIfKnown;
  }
  m.def("_as", &as<SE3<double>>, py::arg("cls"), py::arg("x"));
  m.def("_as", &as<Motion<double>>, py::arg("cls"), py::arg("x"));
  m.def("_as", &as<Force<double>>, py::arg("cls"), py::arg("x"));
  m.def("_as", &as<Inertia<double>>, py::arg("cls"), py::arg("x"));
}

}  // namespace dyn::python
