// SPDX-License-Identifier: BSD-2-Clause
// From Python objects to the C++ objects in them, for functions that are called often.
#pragma once

#include "module.hpp"

#include <dyn/data/batch_data.hpp>

#include <atomic>
#include <cstring>
#include <stdexcept>
#include <string>

namespace dyn::python {

/// A Data and its model. Every Data of Python is one.
struct DataOfModel : Data {
  DataOfModel(const CompactModel& m, Need needs) : Data(m, needs), model(m) {}
  CompactModel model;
};
inline const CompactModel& modelOf(const Data& data) { return static_cast<const DataOfModel&>(data).model; }

/// A batch, and whether a call is using it. Calls of a batch release the interpreter's lock, so a second thread may come.
template <class T>
struct Batch {
  Batch(const CompactModel& model, int capacity, Need needs, int threads) : data(model, capacity, needs, threads) {}
  BasicBatchData<T> data;
  std::atomic<bool> busy = false;
  int placed = 0;  ///< states of the last forward_kinematics()
};

/// Marks memory as used by one call. Throws RuntimeError if another call is using it.
class InUse {
 public:
  InUse(std::atomic<bool>& busy, const char* function) : busy_(busy) {
    if (busy.exchange(true)) throw std::runtime_error(std::string(function) + ": another thread is using this batch; each thread needs its own");
  }
  ~InUse() { busy_ = false; }
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  std::atomic<bool>& busy_;
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
  if (PyObject_TypeCheck(object, type) && reinterpret_cast<py::detail::instance*>(object)->get_value_and_holder().value_ptr() == nullptr) {
    PyErr_Format(PyExc_TypeError, "%s: %s is a %s whose __init__ has not run", function, name, std::strrchr(type->tp_name, '.') + 1);
    return nullptr;
  }
  py::detail::type_caster<T> caster;
  if (caster.load(py::handle(object), false)) return static_cast<T*>(caster);
  PyErr_Format(PyExc_TypeError, "%s: %s must be a %s, not %R", function, name, std::strrchr(type->tp_name, '.') + 1, Py_TYPE(object));
  return nullptr;
}

}  // namespace dyn::python
