// SPDX-License-Identifier: BSD-2-Clause
// dyn plugin list. The other subcommands of dyn plugin have files of their own.
#include "plugin.hpp"

#include "messages.hpp"

#include <dyn/joint/registry.hpp>

#include <cstdio>

namespace dyn::tool {

namespace {

void printType(const JointTypeInfo& info, const char* kind) {
  std::printf("  %-16s %-8s %s\n", info.name, kind, info.summary);
  for (int i = 0; i < info.parameter_count; ++i) {
    const ParameterSpec& p = info.parameters[i];
    std::printf("      %s%s%s%s%s: %s\n", p.name, p.required ? "" : " (optional)", *p.unit ? " [" : "", p.unit, *p.unit ? "]" : "", p.help);
  }
}

void list() {
  const JointRegistry registry = JointRegistry::standard();
  for (const std::string& folder : registry.searched()) std::printf("searched %s\n", folder.c_str());
  for (const PluginRecord& plugin : registry.plugins()) {
    if (plugin.problem.empty()) {
      std::printf("loaded %s\n", plugin.path.c_str());
      if (!plugin.remark.empty()) std::printf("  but %s\n", plugin.remark.c_str());
    } else {
      std::printf("not loaded: %s\n", plugin.problem.c_str());
    }
  }
  std::printf("\n%s\n", heading("types").c_str());
  for (const JointType* type : registry.jointTypes()) printType(type->info(), "joint");
  for (const CouplingType* type : registry.couplingTypes()) printType(type->info(), "coupling");
}

}  // namespace

void addPlugin(CLI::App& app) {
  CLI::App* sub = addCommand(app, "plugin", "joint plugins");
  sub->require_subcommand(1);
  addCommand(*sub, "list", "the folders searched, the plugins found, their types and parameters")->callback([] { list(); });
  addPluginCheck(*sub);
  addPluginNew(*sub);
}

}  // namespace dyn::tool
