// SPDX-License-Identifier: BSD-2-Clause
// Python functions that C++ calls in a simulation.
#pragma once

#include "module.hpp"

#include <dyn/data/views.hpp>
#include <dyn/error.hpp>

#include <pybind11/eigen.h>

#include <exception>
#include <string>
#include <utility>

namespace dyn::python {

/// The exception that a Python function has thrown in this thread. The library itself says only that a callback threw.
inline std::exception_ptr& thrownHere() {
  static thread_local std::exception_ptr thrown;
  return thrown;
}

/// Calls `function` and throws what a Python function has thrown in it, a KeyboardInterrupt too.
template <class F>
auto withPythonExceptions(F&& function) {
  thrownHere() = nullptr;
  try {
    return function();
  } catch (...) {
    if (thrownHere()) std::rethrow_exception(std::exchange(thrownHere(), nullptr));
    throw;
  }
}

/// Runs Python code within a call from C++: takes the interpreter's lock, answers Ctrl-C, and keeps an exception for withPythonExceptions().
template <class Code>
void runPython(Code&& code) {
  try {
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    code();
  } catch (...) {
    thrownHere() = std::current_exception();
    throw;
  }
}

/// Calls a Python function of time and state with copies, which Python may keep, and use(result).
template <class Use>
void callPython(const py::function& function, double t, const VectorResult& q, const VectorResult& v, Use&& use) {
  runPython([&] { use(function(t, Eigen::VectorXd(q), Eigen::VectorXd(v))); });
}

/// Returns what a Python function returned as a T. Throws TypeError, which says what the function must return, for anything else.
template <class T>
T returned(const py::object& result, const char* function, const char* wanted) {
  try {
    return py::cast<T>(result);
  } catch (const py::cast_error&) {
    const std::string kind = py::str(py::type::of(result).attr("__name__"));
    throw py::type_error(std::string(function) + " must return " + wanted + ", not " + (result.is_none() ? "None" : "an object of type " + kind));
  }
}

/// Writes an array that a Python function returned to `out`, a vector or a matrix.
template <class Out>
void writeReturned(const py::object& array, const char* function, Out&& out) {
  const auto values = returned<Eigen::MatrixXd>(array, function, "an array of numbers");
  if (values.size() != out.size() || (out.cols() > 1 && values.rows() != out.rows()))
    throw Error(ErrorCode::size, std::string(function) + " returned " + std::to_string(values.size()) + " numbers, not " +
                                     (out.cols() > 1 ? std::to_string(out.rows()) + " x " + std::to_string(out.cols()) : std::to_string(out.size())));
  Eigen::Map<Eigen::MatrixXd>(out.data(), values.rows(), values.cols()) = values;
}

}  // namespace dyn::python
