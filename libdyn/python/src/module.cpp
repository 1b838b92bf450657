// SPDX-License-Identifier: BSD-2-Clause
// The compiled part of the Python module, and its exception.
#define PY_ARRAY_UNIQUE_SYMBOL DYN_PYTHON_NUMPY
#include "module.hpp"

#include <dyn/error.hpp>
#include <dyn/version.hpp>

#include <numpy/arrayobject.h>

#include <new>

namespace dyn::python {

namespace {

PyObject* error_type = nullptr;

const char* nameOf(ErrorCode code) {
  static constexpr const char* names[] = {"argument", "size",     "file",     "syntax",  "model",  "joint_type", "parameter",
                                          "plugin",   "singular", "compiler", "closure", "memory", "simulation"};
  return names[static_cast<int>(code)];
}

/// Sets libdyn.Error with the attributes code, file, line and joint.
void raise(const Error& e) {
  try {
    py::object error = py::reinterpret_steal<py::object>(PyObject_CallFunction(error_type, "s", e.what()));
    if (!error) return;
    error.attr("code") = nameOf(e.code());
    error.attr("file") = e.where().file;
    error.attr("line") = e.where().line;
    error.attr("joint") = e.where().joint;
    PyErr_SetObject(error_type, error.ptr());
  } catch (py::error_already_set& problem) {
    problem.restore();
  }
}

}  // namespace

PyObject* fail() {
  try {
    throw;
  } catch (const Error& e) {
    raise(e);
  } catch (py::error_already_set& e) {
    e.restore();
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::exception& e) {
    PyErr_SetString(PyExc_RuntimeError, e.what());
  }
  return nullptr;
}

void addErrors(py::module_& m) {
  error_type = PyErr_NewExceptionWithDoc("libdyn.Error",
                                         "What libdyn reports: the message says what was wrong, where, and what to do.\n\n"
                                         "Attributes: code (such as 'size' or 'model'), file, line (0: unknown), joint.",
                                         PyExc_ValueError, nullptr);
  if (error_type == nullptr) throw py::error_already_set();
  m.add_object("Error", py::reinterpret_borrow<py::object>(error_type));
  py::register_exception_translator([](std::exception_ptr e) {
    try {
      if (e) std::rethrow_exception(e);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

}  // namespace dyn::python

PYBIND11_MODULE(_core, m) {
  if (_import_array() < 0) throw pybind11::error_already_set();
  using namespace dyn::python;
  addErrors(m);
  addSpatial(m);
  addSubclasses(m);
  addLie(m);
  addInertialParameters(m);
  addDescription(m);
  addFiles(m);
  addJointTypes(m);
  addCompactModel(m);
  addData(m);
  addConfiguration(m);
  addKinematics(m);
  addFunctions(m);
  addConstraints(m);
  addFrameConstraint(m);
  addGeometry(m);
  addDerivatives(m);
  addSimulation(m);
  m.attr("__version__") = dyn::version().number;
}
