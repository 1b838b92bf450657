// SPDX-License-Identifier: BSD-2-Clause
#include "model_options.hpp"

#include "messages.hpp"
#include "options.hpp"

#include <dyn/parsers/srdf.hpp>
#include <dyn/version.hpp>

namespace dyn::tool {

namespace {

std::vector<std::string> formatNames() {
  std::vector<std::string> names;
  for (const ModelFormat& known : modelFormats()) names.push_back(known.name);
  names.emplace_back("python");
  return names;
}

}  // namespace

void ModelOptions::add(CLI::App& app) {
  app.add_option("MODEL", path, "model file of any format, or a Python file that leaves a `model` (which runs python3)")
      ->type_name("FILE")
      ->required()
      ->check(fileName());
  app.add_option("--format", format, "format of MODEL, if neither its ending nor its content tells it")->check(CLI::IsMember(formatNames()));
  app.add_option("--root", root, "joint between the world and the root link: fixed, free_flyer, or any joint type that needs no parameters")
      ->capture_default_str();
  app.add_option("--mimic", mimic, "mimic joints move on their own, or follow their masters")
      ->check(CLI::IsMember({"independent", "coupled"}))
      ->capture_default_str();
  app.add_option("--order", order, "siblings by joint name, or as in the file")->check(CLI::IsMember({"name", "file"}))->capture_default_str();
  app.add_option("--continuous", continuous, "continuous joints have q = (cos, sin), or one angle")
      ->check(CLI::IsMember({"unit_circle", "angle"}))
      ->capture_default_str();
  app.add_option("--inertia", inertia, "refuse inertias that no body has, or load them as they are")
      ->check(CLI::IsMember({"physical", "any"}))
      ->capture_default_str();
  app.add_option("--files", files, "files that MODEL includes lie beside it or in folders below, or anywhere")
      ->check(CLI::IsMember({"beside", "anywhere"}))
      ->capture_default_str();
  app.add_option("--versions", versions, "refuse files of a newer version of their format, or read what is understood")
      ->check(CLI::IsMember({"known", "any"}))
      ->capture_default_str();
  app.add_option("--srdf", srdf, "groups and named states of the robot, and pairs of links that are not checked for collision")
      ->type_name("FILE")
      ->check(fileName());
  app.add_option("--plugin", plugins, "load this shared object too (repeatable)")->type_name("FILE");
  app.add_option("--lock", lock, "hold this joint at neutral (repeatable)");
  app.add_flag("--losses", losses, "joint damping and friction of the model act in the dynamics");
  app.add_flag("--any-plugin", any_plugin, "load plugins that others can write, too");
}

JointRegistry ModelOptions::registry() const {
  const Trust trust = any_plugin ? Trust::any : Trust::owner_only;
  JointRegistry registry = timed("loaded the plugins", [&] {
    JointRegistry loaded = JointRegistry::standard(trust);
    for (const std::string& plugin : plugins) loaded.load(plugin, trust);
    if (isPython())
      for (const std::string& plugin : python().plugins) loaded.load(plugin, trust);
    return loaded;
  });
  for (const PluginRecord& plugin : registry.plugins())
    detail(plugin.problem.empty() ? "plugin " + plugin.path + " has " + std::to_string(plugin.types.size()) + " types"
                                  : "plugin not loaded: " + plugin.problem);
  return registry;
}

LoadOptions ModelOptions::loadOptions() const {
  LoadOptions options;
  options.root = root;
  options.mimic = mimic == "coupled" ? Mimic::coupled : Mimic::independent;
  options.order = order == "file" ? Order::file : Order::name;
  options.continuous = continuous == "angle" ? Continuous::angle : Continuous::unit_circle;
  options.inertias = inertia == "any" ? Inertias::any : Inertias::physical;
  options.files = files == "anywhere" ? Files::anywhere : Files::beside;
  options.versions = versions == "any" ? Versions::any : Versions::known;
  return options;
}

bool ModelOptions::isPython() const { return format == "python" || (format.empty() && path.ends_with(".py")); }

const PythonModel& ModelOptions::python() const {
  if (!python_) python_ = std::make_shared<const PythonModel>(runModelFile(path, root));
  return *python_;
}

Model ModelOptions::read() const {
  Model model = timed("read " + path, [&] {
    if (isPython()) return python().model;
    return load(path, loadOptions(), format);
  });
  if (!srdf.empty()) timed("read " + srdf, [&] { srdf::load(srdf, model); });
  return model;
}

std::vector<Error> ModelOptions::problems() const {
  if (!isPython()) return check(path, loadOptions(), format);
  try {
    read();
    return {};
  } catch (const Error& e) {
    return {e};
  }
}

CompactModel ModelOptions::compile(const Model& described, const JointRegistry& registry) const {
  return timed("compiled '" + described.name + "' for " + version().instruction_set,
               [&] { return dyn::compile(described, registry, compileOptions()); });
}

Model ModelOptions::description() const {
  Model description = read();
  printNotes(description);
  return description;
}

void printNotes(const Model& description) {
  for (const std::string& note : description.notes) tool::note(note);
}

CompileOptions ModelOptions::compileOptions() const {
  CompileOptions options;
  options.dissipation = losses;
  for (const std::string& joint : lock) options.lock.push_back({joint, {}});
  return options;
}

}  // namespace dyn::tool
