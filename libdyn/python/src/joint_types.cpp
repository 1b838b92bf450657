// SPDX-License-Identifier: BSD-2-Clause
// Joint types written in Python: their functions arrive as lists of operations, and become plugins.
#include "description.hpp"

#include <dyn/codegen/joint_source.hpp>

#include <pybind11/stl.h>

namespace dyn::python {

namespace {

/// A function as Python recorded it: tuples (operation, argument...), where arguments are numbers of earlier nodes.
struct Tape {
  int inputs;
  py::list nodes;
  std::vector<std::size_t> outputs;
};

Operation operationNamed(const std::string& name) {
  static const std::map<std::string, Operation> names{
      {"input", Operation::input},       {"constant", Operation::constant}, {"add", Operation::add},       {"subtract", Operation::subtract},
      {"multiply", Operation::multiply}, {"divide", Operation::divide},     {"negate", Operation::negate}, {"sqrt", Operation::sqrt},
      {"sin", Operation::sin},           {"cos", Operation::cos},           {"tan", Operation::tan},       {"exp", Operation::exp},
      {"log", Operation::log},           {"atan2", Operation::atan2},       {"abs", Operation::abs},       {"select_less", Operation::select_less}};
  const auto found = names.find(name);
  if (found == names.end()) throw Error(ErrorCode::argument, "'" + name + "' is no operation of a traced function");
  return found->second;
}

Graph graphOf(const Tape& tape) {
  return traceFunction(tape.inputs, static_cast<int>(tape.outputs.size()), [&](const Traced* in, Traced* out) {
    std::vector<Traced> values;
    for (const py::handle& node : tape.nodes) {
      const auto parts = py::cast<py::tuple>(node);
      const Operation operation = operationNamed(py::cast<std::string>(parts[0]));
      if (operation == Operation::constant) {
        values.emplace_back(py::cast<double>(parts[1]));
      } else if (operation == Operation::input) {
        const auto k = py::cast<int>(parts[1]);
        if (k < 0 || k >= tape.inputs) throw Error(ErrorCode::argument, "a traced function has no input " + std::to_string(k));
        values.push_back(in[k]);
      } else {
        std::vector<Traced> arguments;
        for (std::size_t k = 1; k < parts.size(); ++k) arguments.push_back(values.at(py::cast<std::size_t>(parts[k])));
        if (static_cast<int>(arguments.size()) != arity(operation))
          throw Error(ErrorCode::argument, "an operation has too few or too many arguments");
        values.push_back(applied(operation, [&](int k) -> const Traced& { return arguments[static_cast<std::size_t>(k)]; }));
      }
    }
    for (std::size_t k = 0; k < tape.outputs.size(); ++k) out[k] = values.at(tape.outputs[k]);
  });
}

using Parameter = std::tuple<std::string, std::string, std::string, int, std::vector<double>>;  // name, unit, help, size, usual
using Tapes = std::map<std::string, std::tuple<int, py::list, std::vector<std::size_t>>>;

TracedJoint tracedJointOf(const std::string& name, const std::string& summary, const std::vector<Parameter>& parameters, int nq, int nv,
                          const Tapes& functions) {
  TracedJoint joint;
  joint.name = name;
  joint.summary = summary;
  joint.nq = nq;
  joint.nv = nv;
  for (const auto& [parameter, unit, help, size, usual] : parameters) joint.parameters.push_back({parameter, unit, help, size, usual});
  const auto graph = [&](const char* function) {
    const auto& [inputs, nodes, outputs] = functions.at(function);
    return graphOf({inputs, nodes, outputs});
  };
  joint.pose = graph("pose");
  if (functions.count("integrate")) {
    joint.space = TracedSpace{graph("neutral"), graph("integrate"), graph("difference"), graph("normalize"), std::nullopt};
    if (functions.count("rates")) joint.space->rates = graph("rates");
  }
  return joint;
}

}  // namespace

void addJointTypes(py::module_& m) {
  m.def(
      "_graph",
      [](int inputs, const py::list& nodes, const std::vector<std::size_t>& outputs) {
        return graphOf({inputs, nodes, outputs});
      },
      py::arg("inputs"), py::arg("nodes"), py::arg("outputs"));
  py::class_<TracedJoint>(m, "_TracedJoint", "The functions of a joint type as graphs.")
      .def(py::init(&tracedJointOf), py::arg("name"), py::arg("summary"), py::arg("parameters"), py::arg("nq"), py::arg("nv"), py::arg("functions"))
      .def("source", &writeJointSource, "Returns the C++ source of a plugin.")
      .def(
          "folder", [](const TracedJoint& joint) { return pluginFolder(joint); }, "Returns names and texts of the files that build a plugin.")
      .def(
          "compile",
          [](const TracedJoint& joint) {
            const py::gil_scoped_release unlocked;
            return compileJointPlugin(joint);
          },
          "Compiles a plugin for this processor, or finds it in the cache; returns its path.")
      .def(
          "register",
          [](const TracedJoint& joint, const std::string& path, bool replace) {
            // A copy, so that the registry stays as it is if the plugin cannot be loaded.
            JointRegistry changed = registry();
            if (replace) changed.remove(joint.name);
            if (path.empty()) {
              changed.add(interpretJoint(joint));
            } else {
              changed.load(path);
            }
            registry() = changed;
          },
          py::arg("path"), py::arg("replace"), "Adds the plugin, or without a path a type that runs the graphs, to registry().");
}

}  // namespace dyn::python
