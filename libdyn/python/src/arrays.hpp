// SPDX-License-Identifier: BSD-2-Clause
// Arguments and results of the functions that are called often, straight from and to numpy's arrays.
#pragma once

#include "module.hpp"

#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/rnea.hpp>
#include <dyn/data/views.hpp>

namespace dyn::python {

/// A vector argument. Contiguous arrays of doubles are read where they lie; other sequences of numbers are copied.
class VectorInput {
 public:
  VectorInput() = default;
  VectorInput(const VectorInput&) = delete;
  VectorInput& operator=(const VectorInput&) = delete;
  ~VectorInput() { Py_XDECREF(copy_); }

  /// Reads the argument `name` of `function`. If it is no vector of numbers, sets TypeError and returns false.
  bool read(PyObject* object, const char* function, const char* name);
  VectorView view() const { return view_; }

 private:
  VectorView view_;
  PyObject* copy_ = nullptr;
};

/// A batch of states, one a row. Rows of numbers of type T that follow one another are read where they lie; other arrays are copied.
template <class T>
class StatesInput {
 public:
  StatesInput() = default;
  StatesInput(const StatesInput&) = delete;
  StatesInput& operator=(const StatesInput&) = delete;
  ~StatesInput() { Py_XDECREF(copy_); }

  bool read(PyObject* object, const char* function, const char* name);
  detail::StatesView<T> view() const { return view_; }

 private:
  detail::StatesView<T> view_;
  PyObject* copy_ = nullptr;
};

/// Reads the argument `fext` of `function`: one row (force, moment) for each joint. If it is no such array, sets TypeError and returns false.
bool readForces(PyObject* object, const char* function, ExternalForces& forces);

/// Returns a new array with these numbers: a vector if there is one column, else a matrix in Fortran's order. Null with a Python error on failure.
PyObject* newArray(const double* numbers, Py_ssize_t rows, Py_ssize_t columns);
/// Returns a read-only array of that shape which views the numbers, and keeps their owner alive.
PyObject* viewArray(const double* numbers, Py_ssize_t rows, Py_ssize_t columns, PyObject* owner);
/// Returns a new array with a rows x columns matrix for each of `states` states (a vector if there is one column), state first.
template <class T>
PyObject* newArrayOfStates(const T* numbers, Py_ssize_t states, Py_ssize_t rows, Py_ssize_t columns);
/// Writes the numbers to the array `out`, which must have the shape of newArray's and doubles in it. Returns false with a Python error if it has not.
bool writeTo(PyObject* out, const char* function, const double* numbers, Py_ssize_t rows, Py_ssize_t columns);

}  // namespace dyn::python
