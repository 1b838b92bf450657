// SPDX-License-Identifier: BSD-2-Clause
// The compiled part of the Python module, and its exception.
#define PY_ARRAY_UNIQUE_SYMBOL DYN_PYTHON_NUMPY
#include "module.hpp"

#include <dyn/version.hpp>

#include <numpy/arrayobject.h>

#include <new>
#include <string>

namespace dyn::python {

namespace {

PyObject *error_type = nullptr, *model_warning = nullptr;

const char* nameOf(ErrorCode code) {
  static constexpr const char* names[] = {"argument", "size",     "file",     "syntax",  "model",  "joint_type", "parameter",
                                          "plugin",   "singular", "compiler", "closure", "memory", "simulation"};
  return names[static_cast<int>(code)];
}

void raise(const Error& e) {
  try {
    PyErr_SetObject(error_type, errorOf(e).ptr());
  } catch (py::error_already_set& problem) {
    problem.restore();
  }
}

/// Throws ImportError if the process has another library. The loader takes a libdyn.so that the process has already, or that LD_LIBRARY_PATH names,
/// for the module's own.
void checkLibrary() {
  const std::string library = version().number;
  if (library != DYN_VERSION)
    throw py::import_error("the module libdyn is of version " DYN_VERSION ", but this process uses the library libdyn of version " + library +
                           "; remove the other library from LD_LIBRARY_PATH, or build the module again");
}

}  // namespace

std::string inPython(const std::string& text) {
  try {
    return py::module_::import("libdyn._names").attr("in_python")(text).cast<std::string>();
  } catch (py::error_already_set& problem) {
    if (!problem.matches(PyExc_Exception)) throw;  // Ctrl-C
    return text;                                   // the text is no UTF-8, or the interpreter is ending
  }
}

py::object errorOf(const Error& e) {
  // "file:line: joint 'j': what was wrong; what to do"
  const Where& where = e.where();
  std::string place = where.file;
  if (where.line > 0) place += ':' + std::to_string(where.line);
  if (!where.joint.empty()) place += (place.empty() ? "" : ": ") + ("joint '" + where.joint + "'");
  std::string text = e.what();
  const std::size_t start = text.starts_with(place) ? place.size() : 0;
  text = text.substr(0, start) + inPython(text.substr(start));
  py::object error = py::reinterpret_steal<py::object>(PyObject_CallFunction(error_type, "s", text.c_str()));
  if (!error) throw py::error_already_set();
  error.attr("code") = nameOf(e.code());
  error.attr("file") = e.where().file;
  error.attr("line") = e.where().line;
  error.attr("joint") = e.where().joint;
  const std::size_t cure = text.rfind("; ");
  error.attr("place") = place;
  error.attr("remedy") = cure == std::string::npos ? "" : text.substr(cure + 2);
  return error;
}

void warn(const std::string& text) {
  if (PyErr_WarnEx(model_warning, inPython(text).c_str(), 1) != 0) throw py::error_already_set();
}

PyObject* fail() {
  try {
    throw;
  } catch (const Error& e) {
    raise(e);
  } catch (py::error_already_set& e) {
    e.restore();
  } catch (const py::builtin_exception& e) {
    e.set_error();
  } catch (const std::bad_alloc&) {
    PyErr_NoMemory();
  } catch (const std::exception& e) {
    PyErr_SetString(PyExc_RuntimeError, e.what());
  }
  return nullptr;
}

void addErrors(py::module_& m) {
  // An error that a Python program makes has these values, and stubs have their types.
  py::dict attributes;
  for (const char* name : {"code", "file", "joint", "place", "remedy"}) attributes[name] = "";
  attributes["line"] = 0;
  error_type = PyErr_NewExceptionWithDoc(
      "libdyn.Error",
      "What libdyn reports: the message says what was wrong, where, and what to do.\n\n"
      "Attributes: code (such as 'size' or 'model'), file, line (0: unknown), joint, place (file, line and joint in one text), "
      "remedy (what to do, where the message says so after a semicolon).",
      PyExc_ValueError, attributes.ptr());
  if (error_type == nullptr) throw py::error_already_set();
  model_warning = PyErr_NewExceptionWithDoc("libdyn.ModelWarning", "What is legal in a model and likely to be a mistake. compile() gives it.",
                                            PyExc_UserWarning, nullptr);
  if (model_warning == nullptr) throw py::error_already_set();
  m.add_object("ModelWarning", py::reinterpret_borrow<py::object>(model_warning));
  m.add_object("Error", py::reinterpret_borrow<py::object>(error_type));
  py::register_exception_translator([](std::exception_ptr e) {
    try {
      if (e) std::rethrow_exception(e);
    } catch (const Error& error) {
      raise(error);
    }
  });
}

namespace {

void addVersion(py::module_& m) {
  py::class_<Version>(m, "Version", "The version of the library in use.")
      .def_readonly("number", &Version::number, "Such as '0.1.0'.")
      .def_readonly("build_type", &Version::build_type, "CMake's build type, such as 'Release'.")
      .def_readonly("instruction_set", &Version::instruction_set, "Of the kernels in use: 'avx512', 'avx2', 'baseline' or 'scalar'.")
      .def_readonly("plugin_interface", &Version::plugin_interface, "The number that plugins must have been built for.");
  m.def("version", &version, "Returns the version of the library in use.");
  m.attr("__version__") = version().number;
}

}  // namespace

}  // namespace dyn::python

// pybind11 waits for ever in a subinterpreter (get_internals()), so that PyInit__core, below, looks for one before pybind11's own function runs.
#define PyInit__core dyn_python_initialize
PYBIND11_MODULE(_core, m) {
  m.doc() = "The compiled part of libdyn. Programs import libdyn.";
  m.attr("__module__") = "libdyn";  // where its classes and functions say that they are
  using namespace dyn::python;
  checkLibrary();
  if (_import_array() < 0) throw pybind11::error_already_set();
  addErrors(m);
  addSpatial(m);
  addLie(m);
  addRegistry(m);
  addSubclasses(m);
  addInertialParameters(m);
  addDescription(m);
  addFiles(m);
  addConformance(m);
  addCompactModel(m);
  addGraphs(m);
  addJointTypes(m);
  addData(m);
  addNamedAccess(m);
  addConfiguration(m);
  addKinematics(m);
  addBatchKinematics(m);
  addFunctions(m);
  addConstraints(m);
  addFriction(m);
  addDelassus(m);
  addShapes(m);
  addGroups(m);
  addFrameConstraint(m);
  addGeometry(m);
  addContactFinders(m);
  addDerivatives(m);
  addCompute(m);
  addSimulation(m);
  addIslands(m);
  addRollout(m);
  addCodegen(m);
  addVersion(m);
  addArgumentErrors(m);
  py::delattr(m, "__module__");
}
#undef PyInit__core

extern "C" PYBIND11_EXPORT PyObject* PyInit__core() {
  if (PyInterpreterState_Get() == PyInterpreterState_Main()) return dyn_python_initialize();
  PyErr_SetString(PyExc_ImportError,
                  "a subinterpreter cannot import libdyn, because its classes belong to the main interpreter; use a thread or a process");
  return nullptr;
}
