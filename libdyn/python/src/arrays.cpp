// SPDX-License-Identifier: BSD-2-Clause
#define NO_IMPORT_ARRAY
#define PY_ARRAY_UNIQUE_SYMBOL DYN_PYTHON_NUMPY
#include "arrays.hpp"

#include <numpy/arrayobject.h>

#include <cstring>

namespace dyn::python {

namespace {

template <class T>
constexpr int type_number = std::is_same_v<T, float> ? NPY_FLOAT : NPY_DOUBLE;

PyArrayObject* asArray(PyObject* object) { return reinterpret_cast<PyArrayObject*>(object); }

/// Returns a new array of `dimensions` with the numbers of any sequence; null with an error that names the argument.
template <class T>
PyObject* converted(PyObject* object, int dimensions, const char* function, const char* name) {
  PyArray_Descr* const wanted = PyArray_DescrFromType(type_number<T>);
  // Only conversions that lose nothing are made; a float batch rounds doubles, as it must.
  const int force = std::is_same_v<T, float> ? NPY_ARRAY_FORCECAST : 0;
  PyObject* const array = PyArray_FromAny(object, wanted, dimensions, dimensions, NPY_ARRAY_CARRAY_RO | NPY_ARRAY_NOTSWAPPED | force, nullptr);
  if (array != nullptr) return array;
  PyErr_Clear();
  const char* const shape = dimensions == 1 ? "one dimension" : "two dimensions, a state a row";
  if (PyArray_Check(object)) {
    PyObject* const dimensions_of = PyObject_GetAttrString(object, "shape");
    if (dimensions_of != nullptr)
      PyErr_Format(PyExc_TypeError, "%s: %s must be an array of numbers with %s, and has dtype %S and shape %S%s", function, name, shape,
                   PyArray_DESCR(asArray(object)), dimensions_of,
                   dimensions == 1 && PyArray_NDIM(asArray(object)) == 2 ? "; BatchData takes many states" : "");
    Py_XDECREF(dimensions_of);
  } else {
    PyErr_Format(PyExc_TypeError, "%s: %s must be an array of numbers with %s, not %R", function, name, shape, Py_TYPE(object));
  }
  return nullptr;
}

}  // namespace

bool VectorInput::read(PyObject* object, const char* function, const char* name) {
  if (PyArray_Check(object)) {
    PyArrayObject* const a = asArray(object);
    if (PyArray_NDIM(a) == 1 && PyArray_TYPE(a) == NPY_DOUBLE && PyArray_ISBEHAVED_RO(a) &&
        (PyArray_STRIDES(a)[0] == sizeof(double) || PyArray_DIMS(a)[0] <= 1)) {
      view_ = {static_cast<const double*>(PyArray_DATA(a)), PyArray_DIMS(a)[0]};
      return true;
    }
  }
  copy_ = converted<double>(object, 1, function, name);
  if (copy_ == nullptr) return false;
  view_ = {static_cast<const double*>(PyArray_DATA(asArray(copy_))), PyArray_DIMS(asArray(copy_))[0]};
  return true;
}

template <class T>
bool StatesInput<T>::read(PyObject* object, const char* function, const char* name) {
  const auto use = [this](PyArrayObject* a) {
    const npy_intp rows = PyArray_DIMS(a)[0], columns = PyArray_DIMS(a)[1];
    const npy_intp step = rows > 1 ? PyArray_STRIDES(a)[0] : columns * static_cast<npy_intp>(sizeof(T));
    const bool rows_follow = columns <= 1 || PyArray_STRIDES(a)[1] == sizeof(T);
    if (!rows_follow || step % static_cast<npy_intp>(sizeof(T)) != 0 || step < columns * static_cast<npy_intp>(sizeof(T))) return false;
    view_ = {static_cast<const T*>(PyArray_DATA(a)), columns, rows, step / static_cast<npy_intp>(sizeof(T)), true};
    return true;
  };
  if (PyArray_Check(object)) {
    PyArrayObject* const a = asArray(object);
    if (PyArray_NDIM(a) == 2 && PyArray_TYPE(a) == type_number<T> && PyArray_ISBEHAVED_RO(a) && use(a)) return true;
  }
  copy_ = converted<T>(object, 2, function, name);
  return copy_ != nullptr && use(asArray(copy_));
}
template class StatesInput<double>;
template class StatesInput<float>;

bool readForces(PyObject* object, const char* function, ExternalForces& forces) {
  StatesInput<double> rows;
  if (!rows.read(object, function, "fext")) return false;
  const auto view = rows.view();
  if (view.rows != 6) {
    PyErr_Format(PyExc_TypeError, "%s: fext must have six columns, force and moment", function);
    return false;
  }
  for (std::ptrdiff_t k = 0; k < view.cols; ++k) {
    const double* const x = view.data + k * view.stride;
    forces.push_back({{x[0], x[1], x[2]}, {x[3], x[4], x[5]}});
  }
  return true;
}

PyObject* newArray(const double* numbers, Py_ssize_t rows, Py_ssize_t columns) {
  npy_intp sizes[] = {rows, columns};
  PyObject* const out = PyArray_EMPTY(columns == 1 ? 1 : 2, sizes, NPY_DOUBLE, 1);
  if (out != nullptr && rows * columns > 0)
    std::memcpy(PyArray_DATA(asArray(out)), numbers, static_cast<std::size_t>(rows * columns) * sizeof(double));
  return out;
}

PyObject* viewArray(const double* numbers, Py_ssize_t rows, Py_ssize_t columns, PyObject* owner) {
  if (rows * columns == 0) return newArray(numbers, rows, columns);
  npy_intp sizes[] = {rows, columns}, steps[] = {sizeof(double), static_cast<npy_intp>(sizeof(double)) * rows};
  // Only a flag says that the array is read-only; numpy's functions take a pointer to numbers that may be written.
  PyObject* const out =
      PyArray_New(&PyArray_Type, columns == 1 ? 1 : 2, sizes, NPY_DOUBLE, steps, const_cast<double*>(numbers), 0, NPY_ARRAY_ALIGNED, nullptr);
  if (out == nullptr) return nullptr;
  Py_INCREF(owner);
  if (PyArray_SetBaseObject(asArray(out), owner) == 0) return out;
  Py_DECREF(out);
  return nullptr;
}

template <class T>
PyObject* newArrayOfStates(const T* numbers, Py_ssize_t states, Py_ssize_t rows, Py_ssize_t columns) {
  npy_intp sizes[] = {states, columns, rows};
  if (columns == 1) sizes[1] = rows;
  PyObject* const out = PyArray_EMPTY(columns == 1 ? 2 : 3, sizes, type_number<T>, 0);
  if (out == nullptr) return nullptr;
  if (states * rows * columns > 0) std::memcpy(PyArray_DATA(asArray(out)), numbers, static_cast<std::size_t>(states * rows * columns) * sizeof(T));
  if (columns == 1) return out;
  PyObject* const turned = PyArray_SwapAxes(asArray(out), 1, 2);
  Py_DECREF(out);
  return turned;
}
template PyObject* newArrayOfStates(const double*, Py_ssize_t, Py_ssize_t, Py_ssize_t);
template PyObject* newArrayOfStates(const float*, Py_ssize_t, Py_ssize_t, Py_ssize_t);

bool writeTo(PyObject* out, const char* function, const double* numbers, Py_ssize_t rows, Py_ssize_t columns) {
  const int dimensions = columns == 1 ? 1 : 2;
  if (!PyArray_Check(out) || PyArray_TYPE(asArray(out)) != NPY_DOUBLE || !PyArray_ISBEHAVED(asArray(out)) ||
      PyArray_NDIM(asArray(out)) != dimensions || PyArray_DIMS(asArray(out))[0] != rows ||
      (dimensions == 2 && PyArray_DIMS(asArray(out))[1] != columns)) {
    if (dimensions == 1) {
      PyErr_Format(PyExc_TypeError, "%s: out must be a writable array of float64 with shape (%zd,)", function, rows);
    } else {
      PyErr_Format(PyExc_TypeError, "%s: out must be a writable array of float64 with shape (%zd, %zd)", function, rows, columns);
    }
    return false;
  }
  const npy_intp* const steps = PyArray_STRIDES(asArray(out));
  char* const data = PyArray_BYTES(asArray(out));
  for (Py_ssize_t c = 0; c < columns; ++c) {
    char* to = data + (dimensions == 2 ? c * steps[1] : 0);
    for (Py_ssize_t r = 0; r < rows; ++r, to += steps[0]) std::memcpy(to, numbers + c * rows + r, sizeof(double));
  }
  return true;
}

}  // namespace dyn::python
