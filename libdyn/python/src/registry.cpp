// SPDX-License-Identifier: BSD-2-Clause
// Joint and coupling types, and the plugins that provide them.
#include "registry.hpp"

#include "choices.hpp"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

namespace dyn::python {

namespace {

using Path = std::filesystem::path;

Trust trustOf(const std::string& name) { return chosen<Trust>("trust", name, {{"owner_only", Trust::owner_only}, {"any", Trust::any}}); }

template <class Types>
std::vector<TypeInfo> infosOf(const Types& types, const char* role) {
  std::vector<TypeInfo> out;
  for (const auto* type : types) out.push_back({&type->info(), role});
  return out;
}

std::vector<ParameterSpec> parametersOf(const TypeInfo& type) { return {type.info->parameters, type.info->parameters + type.info->parameter_count}; }

std::vector<std::string> closedFormsOf(const TypeInfo& type) {
  std::vector<std::string> out;
  for (const auto& [bit, name] : {std::pair(closed_subspace, "subspace"), std::pair(closed_bias, "bias"),
                                  std::pair(closed_configuration, "configuration"), std::pair(own_rates, "rates")})
    if (type.info->closed_forms & bit) out.emplace_back(name);
  return out;
}

const char* parameterKindOf(const ParameterSpec& p) {
  static constexpr const char* names[] = {"number", "vector3", "numbers", "text", "joints"};
  return names[static_cast<int>(p.kind)];
}

void addTypes(py::module_& m) {
  py::class_<ParameterSpec>(m, "ParameterSpec", "A parameter of a joint or coupling type.")
      .def_readonly("name", &ParameterSpec::name, "The name by which models give it.")
      .def_property_readonly("kind", &parameterKindOf, "'number', 'vector3', 'numbers', 'text' or 'joints'.")
      .def_readonly("required", &ParameterSpec::required, "Whether a model must give it.")
      .def_readonly("unit", &ParameterSpec::unit, "Its unit; empty if it has none.")
      .def_readonly("help", &ParameterSpec::help, "Its meaning.")
      .def_readonly("example", &ParameterSpec::example, "A value that the type accepts, as text; None if the author gives none.")
      .def("__repr__", [](const ParameterSpec& p) { return "<parameter '" + std::string(p.name) + "': " + parameterKindOf(p) + ">"; });
  py::class_<TypeInfo>(m, "JointTypeInfo", "The description of a joint or coupling type.")
      .def_property_readonly(
          "name", [](const TypeInfo& t) { return t.info->name; }, "The name by which models name the type.")
      .def_property_readonly(
          "summary", [](const TypeInfo& t) { return t.info->summary; }, "One line for people.")
      .def_readonly("role", &TypeInfo::role, "'joint' or 'coupling'.")
      .def_property_readonly(
          "is_series", [](const TypeInfo& t) { return t.info->structure == Structure::series; }, "Whether it is a list of joints.")
      .def_property_readonly("closed_forms", &closedFormsOf,
                             "Parts that the author wrote in closed form, out of 'subspace', 'bias', 'configuration' and 'rates'.")
      .def_property_readonly(
          "parameters", [](const TypeInfo& t) { return parametersOf(t); }, "A ParameterSpec for each parameter, in the author's order.")
      .def("__repr__", [](const TypeInfo& t) { return "<" + std::string(t.role) + " type '" + t.info->name + "'>"; });
  py::class_<PluginRecord>(m, "PluginRecord", "A plugin that was loaded or refused, or a folder that could not be read.")
      .def_readonly("path", &PluginRecord::path, "The file or folder, as it was named.")
      .def_readonly("types", &PluginRecord::types, "The names of its types; empty if it was not loaded.")
      .def_readonly("problem", &PluginRecord::problem, "Why it was not loaded; empty if it was.")
      .def_readonly("remark", &PluginRecord::remark, "What is wrong with a plugin that was loaded; else empty.")
      .def_readonly("fast", &PluginRecord::fast, "The file with its build for this processor; empty if there is none.")
      .def("__repr__", [](const PluginRecord& p) { return "<plugin '" + p.path + (p.problem.empty() ? "'>" : "', not loaded>"); });
}

void addRegistryClass(py::module_& m) {
  const py::arg path("path"), name("name");
  const py::arg_v trust("trust", "owner_only");
  py::class_<JointRegistry>(m, "JointRegistry",
                            "Joint and coupling types by name. They come from plugins, which stay loaded until the process ends.\n\n"
                            "trust: with 'owner_only', files that other users could have changed are refused; 'any' skips this check.")
      .def(py::init<>(), "Makes a registry without types.")
      .def_static(
          "standard", [](const std::string& t) { return JointRegistry::standard(trustOf(t)); }, trust,
          "Returns a registry with the standard plugins, then those in the folders of DYN_PLUGIN_PATH (separated by ':').")
      .def(
          "load", [](JointRegistry& r, const Path& p, const std::string& t) { r.load(p.string(), trustOf(t)); }, path, trust,
          "Loads one plugin. Raises Error and changes nothing if it cannot be loaded. Loading a file again changes nothing.")
      .def(
          "load_directory", [](JointRegistry& r, const Path& p, const std::string& t) { r.loadDirectory(p.string(), trustOf(t)); }, path, trust,
          "Loads every *.so of a folder, in the order of their names. Failures are in `plugins`.")
      .def(
          "joint_type",
          [](const JointRegistry& r, const std::string& n) {
            return TypeInfo{&r.jointType(n).info(), "joint"};
          },
          name, "Returns the description of a joint type. Raises Error with all places searched if there is none.")
      .def(
          "coupling_type",
          [](const JointRegistry& r, const std::string& n) {
            return TypeInfo{&r.couplingType(n).info(), "coupling"};
          },
          name, "Returns the description of a coupling type. Raises Error with all places searched if there is none.")
      .def_property_readonly(
          "joint_types", [](const JointRegistry& r) { return infosOf(r.jointTypes(), "joint"); }, "All joint types, in the order of loading.")
      .def_property_readonly(
          "coupling_types", [](const JointRegistry& r) { return infosOf(r.couplingTypes(), "coupling"); },
          "All coupling types, in the order of loading.")
      .def_property_readonly("plugins", &JointRegistry::plugins, "A PluginRecord for each plugin loaded, and for each failure of load_directory().")
      .def_property_readonly("searched", &JointRegistry::searched, "The folders that were searched.")
      .def("__copy__", [](const JointRegistry& r) { return r; })
      .def("__repr__", [](const JointRegistry& r) {
        return "<libdyn.JointRegistry: " + std::to_string(r.jointTypes().size()) + " joint types, " + std::to_string(r.couplingTypes().size()) +
               " coupling types>";
      });
  m.def("registry", &registry, py::return_value_policy::reference,
        "Returns the registry of this process, which functions use unless they are given another one.");
  m.def(
      "load_plugin", [](const Path& p, const std::string& t) { registry().load(p.string(), trustOf(t)); }, path, trust,
      "Loads one plugin into registry(). Models that are compiled already keep their types.");
}

}  // namespace

JointRegistry& registry() {
  static JointRegistry types = JointRegistry::standard();
  return types;
}

const JointRegistry& registryOr(const JointRegistry* given) { return given ? *given : registry(); }

void addRegistry(py::module_& m) {
  addTypes(m);
  addRegistryClass(m);
}

}  // namespace dyn::python
