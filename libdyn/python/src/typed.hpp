// SPDX-License-Identifier: BSD-2-Clause
// Python objects whose signatures say more than "function" or "dict". Type stubs are made of signatures (stubs.py).
#pragma once

#include "module.hpp"

#include <cstddef>
#include <type_traits>
#include <utility>

namespace dyn::python {

/// The text of a type in the terms of Python's module typing, with NDArray and ArrayLike of numpy.typing.
template <std::size_t n>
struct TypeText {
  char text[n] = {};
  constexpr TypeText(const char (&given)[n]) {  // NOLINT: meant to convert
    for (std::size_t k = 0; k < n; ++k) text[k] = given[k];
  }
};

/// A Base, such as py::function, whose type in signatures is `type`. Only the Base is checked when a function is called.
template <class Base, TypeText type>
class Typed : public Base {
 public:
  using Base::Base;
  Typed(Base x) : Base(std::move(x)) {}  // NOLINT: meant to convert
  /// Returns whether an argument is a Base, as pybind11 asks its own types.
  static bool check_(py::handle x) {
    if constexpr (std::is_same_v<Base, py::object>)
      return x.ptr() != nullptr;
    else
      return Base::check_(x);
  }
};

}  // namespace dyn::python

template <class Base, dyn::python::TypeText written>
struct pybind11::detail::handle_type_name<dyn::python::Typed<Base, written>> {
  static constexpr auto name = const_name(written.text);
};
