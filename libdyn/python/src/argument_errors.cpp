// SPDX-License-Identifier: BSD-2-Clause
// Short errors for arguments that fit no signature of a function.
//
// pybind11 answers such a call with all signatures and all arguments. Its functions share one entry. This source puts an entry of its own in front
// of it, which lets libdyn/_arguments.py say which argument does not fit and what is accepted.
#include "module.hpp"

#include <pybind11/detail/internals.h>

#include <string>
#include <unordered_map>

namespace dyn::python {

namespace {

struct Known {
  std::string name;  ///< such as SE3.act
  const PyMethodDef* definition;
};

PyCFunctionWithKeywords entry_of_pybind11 = nullptr;

/// The functions of the module by the objects that pybind11 keeps their signatures in.
std::unordered_map<PyObject*, Known>& functions() {
  static auto* const all = new std::unordered_map<PyObject*, Known>;  // functions may be called until the process ends
  return *all;
}

/// Replaces pybind11's error for a call, if that is what is set, by a TypeError that names the argument.
void explain(PyObject* self, PyObject* arguments, PyObject* keywords) {
  py::error_already_set problem;
  try {
    const std::string text = py::str(problem.value());
    const bool by_pybind11 = text.find("(): incompatible function arguments.") != std::string::npos ||
                             text.find("(): incompatible constructor arguments.") != std::string::npos;
    const auto known = functions().find(self);
    // A method that takes its own object as it is finds another one in an unbound call, such as Model.add_body(3, ...).
    if (text.starts_with("Unable to cast Python instance") && known != functions().end())
      return PyErr_SetString(PyExc_TypeError, (known->second.name + ": an argument is of another class than this function takes").c_str());
    if (by_pybind11 && known != functions().end()) {
      const py::object named = keywords != nullptr ? py::reinterpret_borrow<py::object>(keywords) : py::dict();
      const auto& [name, definition] = known->second;
      const py::object better = py::module_::import("libdyn._arguments").attr("explain")(name, definition->ml_doc, py::handle(arguments), named);
      if (!better.is_none()) return PyErr_SetObject(PyExc_TypeError, better.ptr());
    }
  } catch (py::error_already_set& other) {
    if (!other.matches(PyExc_Exception)) return other.restore();  // Ctrl-C
  }
  problem.restore();
}

PyObject* call(PyObject* self, PyObject* arguments, PyObject* keywords) {
  PyObject* const result = entry_of_pybind11(self, arguments, keywords);
  if (result == nullptr && (PyErr_ExceptionMatches(PyExc_TypeError) || PyErr_ExceptionMatches(PyExc_RuntimeError)))
    explain(self, arguments, keywords);
  return result;
}

PyCFunctionWithKeywords entryOf(PyObject* function) {
  const PyMethodDef* const definition = reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  if ((definition->ml_flags & (METH_VARARGS | METH_KEYWORDS | METH_FASTCALL)) != (METH_VARARGS | METH_KEYWORDS)) return nullptr;
  return reinterpret_cast<PyCFunctionWithKeywords>(reinterpret_cast<void (*)()>(definition->ml_meth));
}

void prepareFunction(PyObject* function, const std::string& name) {
  if (PyInstanceMethod_Check(function)) function = PyInstanceMethod_GET_FUNCTION(function);
  if (!PyCFunction_Check(function) || entryOf(function) != entry_of_pybind11) return;
  PyMethodDef* const definition = reinterpret_cast<PyCFunctionObject*>(function)->m_ml;
  functions().emplace(PyCFunction_GET_SELF(function), Known{name, definition});
  definition->ml_meth = reinterpret_cast<PyCFunction>(reinterpret_cast<void (*)()>(&call));
}

void prepareAll(const py::handle& scope, const std::string& prefix) {
  // A copy: an attribute of a class may not change while its dictionary is read.
  for (const auto& [key, value] : py::dict(scope.attr("__dict__").attr("copy")())) {
    const std::string name = key.cast<std::string>();
    const std::string here = name == "__init__" ? prefix.substr(0, prefix.size() - 1) : prefix + name;
    if (PyObject_IsInstance(value.ptr(), reinterpret_cast<PyObject*>(&PyProperty_Type)) == 1) {
      prepareFunction(value.attr("fget").ptr(), here);
      prepareFunction(value.attr("fset").ptr(), here);
    } else if (PyObject_TypeCheck(value.ptr(), &PyStaticMethod_Type)) {
      prepareFunction(value.attr("__func__").ptr(), here);
    } else if (Py_TYPE(value.ptr()) == py::detail::get_internals().default_metaclass || PyModule_Check(value.ptr())) {
      prepareAll(value, here + ".");
    } else {
      prepareFunction(value.ptr(), here);
    }
  }
}

}  // namespace

void addArgumentErrors(py::module_& m) {
  entry_of_pybind11 = entryOf(py::cpp_function([] {}).ptr());
  prepareAll(m, "");
}

}  // namespace dyn::python
