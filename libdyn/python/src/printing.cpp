// SPDX-License-Identifier: BSD-2-Clause
#include "printing.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace dyn::python {

std::string written(const py::handle& value) {
  if (py::hasattr(value, "tolist")) return written(value.attr("tolist")());
  if (py::isinstance<py::list>(value)) {
    std::string out;
    for (const py::handle element : value) out += (out.empty() ? "" : ", ") + written(element);
    return "[" + out + "]";
  }
  if (!PyFloat_CheckExact(value.ptr())) return py::repr(value);
  const int digits = std::clamp(py::module_::import("numpy").attr("get_printoptions")()["precision"].cast<int>(), 1, 17);
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value.cast<double>());
  const double rounded = std::strtod(text, nullptr);
  return py::repr(py::float_(rounded == 0 ? 0.0 : rounded));
}

std::string writtenCall(const py::handle& type, const py::tuple& parts) {
  std::string out = py::str(type.attr("__name__")).cast<std::string>() + "(";
  for (std::size_t k = 0; k < parts.size(); ++k) out += (k ? ", " : "") + written(parts[k]);
  return out + ")";
}

std::string writtenBits(const py::handle& value) {
  const py::handle type = py::type::of(value);
  const std::string name = py::str(type.attr("__name__"));
  const auto number = [](const py::handle& x) { return py::int_(py::reinterpret_borrow<py::object>(x)).cast<int>(); };
  const int bits = number(value);
  std::string out;
  int written = 0;
  for (const auto& [member, of_member] : py::dict(type.attr("__members__"))) {
    const int mine = number(of_member);
    if (bits == mine) return name + "." + py::str(member).cast<std::string>();
    // A value that comes with another one is not named twice.
    if (mine == 0 || (bits & mine) != mine) continue;
    out += (out.empty() ? "" : "|") + name + "." + py::str(member).cast<std::string>();
    written |= mine;
  }
  return written == bits ? out : name + "(" + std::to_string(bits) + ")";
}

}  // namespace dyn::python
