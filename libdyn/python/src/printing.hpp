// SPDX-License-Identifier: BSD-2-Clause
// Texts of objects: constructor calls for values, names in angle brackets for parts of a model.
#pragma once

#include "module.hpp"

#include <string>
#include <vector>

namespace dyn::python {

/// Writes a number, list or array of numbers with at most as many digits as numpy prints (8 by default), and no more than a number needs: 0.3, not
/// 0.30000000000000004.
std::string written(const py::handle& value);
/// Writes the call that makes an object: Name(part, part).
std::string writtenCall(const py::handle& type, const py::tuple& parts);
/// Writes the values of an enumeration whose bits are combined: Need.MASS_MATRIX|Need.DERIVATIVES.
std::string writtenBits(const py::handle& value);

/// Answers pickle for objects that another process makes of the description. Copies of batches and other memory are refused by it, too.
template <class T>
py::tuple refusePickle(const T&) {
  const std::string name = py::str(py::type::of<T>().attr("__name__"));
  throw py::type_error("a " + name + " cannot be pickled; pickle the Model, and make this of it in the other process");
}

/// Adds a repr: the call of the constructor with arguments(object).
template <class Class, class Arguments>
void printed(Class& c, const Arguments& arguments) {
  using T = typename Class::type;
  c.def("__repr__", [arguments](const py::object& self) { return writtenCall(py::type::of(self), arguments(py::cast<const T&>(self))); });
}

}  // namespace dyn::python
