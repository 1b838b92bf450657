// SPDX-License-Identifier: BSD-2-Clause
// Spatial quantities as instances of classes that Python derives from ours.
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

}  // namespace

void addSubclasses(py::module_& m) {
  m.def("_as", &as<SE3<double>>);
  m.def("_as", &as<Motion<double>>);
  m.def("_as", &as<Force<double>>);
  m.def("_as", &as<Inertia<double>>);
}

}  // namespace dyn::python
