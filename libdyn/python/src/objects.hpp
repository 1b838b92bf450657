// SPDX-License-Identifier: BSD-2-Clause
// From Python objects to the C++ objects in them, for functions that are called often.
#pragma once

#include "module.hpp"

#include <dyn/data/batch_data.hpp>

#include <atomic>
#include <cstring>

namespace dyn::python {

/// A batch, and whether a call is using it. Calls of a batch release the interpreter's lock, so a second thread may come.
template <class T>
struct Batch {
  Batch(const CompactModel& model, int capacity, Need needs, int threads) : data(model, capacity, needs, threads) {}
  BasicBatchData<T> data;
  std::atomic<bool> busy = false;
};

/// Returns the Python class of T.
template <class T>
PyTypeObject* typeOf() {
  static PyTypeObject* const type = reinterpret_cast<PyTypeObject*>(py::type::of<T>().release().ptr());
  return type;
}

/// Returns the C++ object in a Python object; null, with TypeError set, if it holds none of class T.
template <class T>
T* pointerTo(PyObject* object, const char* function, const char* name) {
  // The class of an object tells what it holds; only derived classes need pybind11's search.
  PyTypeObject* const type = typeOf<T>();
  if (Py_TYPE(object) == type) {
    auto* const instance = reinterpret_cast<py::detail::instance*>(object);
    if (instance->simple_layout && instance->simple_value_holder[0] != nullptr) return static_cast<T*>(instance->simple_value_holder[0]);
  }
  py::detail::type_caster<T> caster;
  if (caster.load(py::handle(object), false)) return static_cast<T*>(caster);
  PyErr_Format(PyExc_TypeError, "%s: %s must be a %s, not %R", function, name, std::strrchr(type->tp_name, '.') + 1, Py_TYPE(object));
  return nullptr;
}

}  // namespace dyn::python
