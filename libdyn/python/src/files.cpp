// SPDX-License-Identifier: BSD-2-Clause
// Models in libdyn's own format, as URDF and MJCF, and their differences.
#include "module.hpp"

#include <dyn/model/difference.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/mjcf.hpp>
#include <dyn/parsers/urdf.hpp>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace dyn::python {

void addFiles(py::module_& m) {
  m.def(
      "save", [](const Model& model, const std::filesystem::path& path) { json::save(model, path.string()); }, py::arg("model"), py::arg("path"),
      "Writes a model to a file of libdyn's own format (NAME.dyn.json), which load() reads back to the same bits. The file is replaced as a whole.");
  const auto written = [](Written x) { return std::pair(std::move(x.text), std::move(x.lost)); };
  m.def(
      "write_urdf", [written](const Model& x) { return written(urdf::write(x)); }, py::arg("model"),
      "Returns a model as the text of a URDF with libdyn's extension, and a list of what URDF cannot say.");
  m.def(
      "save_urdf", [](const Model& x, const std::filesystem::path& path) { return urdf::save(x, path.string()); }, py::arg("model"), py::arg("path"),
      "Replaces a file by that text, as a whole; returns the list of what URDF cannot say.");
  m.def(
      "write_mjcf", [written](const Model& x) { return written(mjcf::write(x)); }, py::arg("model"),
      "Returns a model as the text of an MJCF, MuJoCo's format, and a list of what MJCF cannot say. Raises Error for types of joints that are no "
      "series "
      "of MuJoCo's.");
  m.def(
      "save_mjcf", [](const Model& x, const std::filesystem::path& path) { return mjcf::save(x, path.string()); }, py::arg("model"), py::arg("path"),
      "Replaces a file by that text, as a whole; returns the list of what MJCF cannot say.");
  py::class_<Difference>(m, "Difference", "One difference between two models, A and B.")
      .def_readonly("topic", &Difference::topic, "Such as 'structure', 'joint', 'placement', 'inertia' or 'limits'.")
      .def_readonly("name", &Difference::name, "The name of the body, joint, frame, volume, ...")
      .def_readonly("what", &Difference::what, "What differs there, such as 'mass [kg]'.")
      .def_readonly("a", &Difference::a, "Its value in A, as a text; '-' if A does not have it.")
      .def_readonly("b", &Difference::b, "Its value in B.")
      .def_readonly("size", &Difference::size, "How far apart the numbers are; infinite where that is no number.")
      .def_readonly("unit", &Difference::unit, "The unit of the size: 'm', 'rad', or '1' for a fraction of the larger value.")
      .def("__repr__", [](const Difference& d) { return "<" + d.topic + " '" + d.name + "', " + d.what + ": " + d.a + " and " + d.b + ">"; });
  m.def("differences", &differences, py::arg("a"), py::arg("b"), py::arg("tolerance") = 1e-9,
        "Returns the differences of two models, whose parts have the same names. Positions [m] and rotations [rad] differ if they are more than the "
        "tolerance apart, other numbers if they are apart by more than this fraction of the larger one.");
  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def(py::pickle([](const Model& model) { return json::write(model); },
                      [](const std::string& text) { return json::parse(text, "a pickled model"); }))
      .def("to_json", &json::write, "Returns the model as a text of libdyn's own format.")
      .def_static(
          "from_json", [](const std::string& text, const std::string& name) { return json::parse(text, name); }, py::arg("text"),
          py::arg("name") = "<text>", "Reads a model from a text of libdyn's own format, which messages call `name`.");
}

}  // namespace dyn::python
