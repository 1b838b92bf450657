// SPDX-License-Identifier: BSD-2-Clause
// Models in libdyn's own format: files, and pickles.
#include "module.hpp"

#include <dyn/parsers/json.hpp>

#include <pybind11/stl/filesystem.h>

namespace dyn::python {

void addFiles(py::module_& m) {
  m.def(
      "save", [](const Model& model, const std::filesystem::path& path) { json::save(model, path.string()); }, py::arg("model"), py::arg("path"),
      "Writes a model to a file of libdyn's own format (NAME.dyn.json), which load() reads back to the same bits. The file is replaced as a whole.");
  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def(py::pickle([](const Model& model) { return json::write(model); },
                      [](const std::string& text) { return json::parse(text, "a pickled model"); }))
      .def("to_json", &json::write, "Returns the model as a text of libdyn's own format.")
      .def_static(
          "from_json", [](const std::string& text, const std::string& name) { return json::parse(text, name); }, py::arg("text"),
          py::arg("name") = "<text>", "Reads a model from a text of libdyn's own format, which messages call `name`.");
}

}  // namespace dyn::python
