// SPDX-License-Identifier: BSD-2-Clause
// dyn plugin new: writes a folder with a joint type to start from.
#include "folder.hpp"
#include "interrupt.hpp"
#include "plugin.hpp"
#include "text.hpp"

#include <dyn/codegen/joint_source.hpp>
#include <dyn/error.hpp>
#include <dyn/file.hpp>
#include <dyn/joint/registry.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace dyn::tool {

namespace {

namespace fs = std::filesystem;

// @NAME@ stands for the type and @CLASS@ for the class.
const char* const source_text =
    R"(// A follower on an eccentric cam: it moves along z by h (1 - cos q) as the cam turns by q. Replace parameters and pose by your joint's.
#include <dyn_sdk/joint_plugin.hpp>

struct @CLASS@ : dyn::sdk::Joint<@CLASS@, 1> {  // 1: degrees of freedom
  static constexpr const char* name = "@NAME@";
  static constexpr const char* summary = "translation along z by h (1 - cos q), q the cam's angle [rad]";
  static constexpr bool branch_free = true;  // no `if` on q below, so it may be computed for several q at once
  static constexpr std::array parameters{dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", "half the stroke"}};

  // Pose of the moving frame at q; c holds the parameters' numbers in the order of the schema. The scalar S may be a dual number:
  // velocities and accelerations are derived from this function.
  template <class S>
  static dyn::SE3<S> pose(const S* q, const auto& c) {
    using std::sin;
    const S half = sin(S(0.5) * q[0]);
    return {dyn::Mat3<S>::identity(), {S(0), S(0), S(2 * c[0]) * half * half}};  // 1 - cos q without cancellation
  }
};

DYN_EXPORT_JOINTS(@CLASS@)
)";

void create(const std::string& name, const std::string& directory) {
  const auto files = [&] {
    try {
      return pluginFolder(name, replaced(replaced(source_text, "@NAME@", name), "@CLASS@", jointClassName(name)), "h=\"0.1\"");
    } catch (const Error& e) {
      throw CLI::ValidationError("NAME", e.what());
    }
  }();
  const JointRegistry registry = JointRegistry::standard();
  for (const PluginRecord& plugin : registry.plugins())
    if (std::find(plugin.types.begin(), plugin.types.end(), name) != plugin.types.end())
      throw Error(ErrorCode::argument,
                  "'" + name + "' is a type of '" + plugin.path + "' already, beside which it would not be loaded; choose another name");
  const fs::path folder = fs::path(directory) / name;
  std::error_code error;
  if (fs::exists(fs::symlink_status(folder, error)))
    throw Error(ErrorCode::file, "exists already; choose another name or --directory", {folder.string(), 0, ""});
  const Interruption interruption;  // the folder is written whole or not at all
  makeFolder(folder.string());
  try {
    for (const auto& [file, text] : files) replaceFile((folder / file).string(), text);
  } catch (...) {
    fs::remove_all(folder, error);
    throw;
  }
  std::printf("wrote CMakeLists.txt, %s.cpp, README.md and %s.urdf to %s\n", name.c_str(), name.c_str(), folder.c_str());
  interruption.end();
}

}  // namespace

void addPluginNew(CLI::App& plugin) {
  CLI::App* sub = addCommand(plugin, "new", "writes a folder with a joint type to start from");
  struct Options {
    std::string name, directory = ".";
  };
  auto o = std::make_shared<Options>();
  sub->add_option("NAME", o->name, "of the type, the files and the folder")->required();
  sub->add_option("--directory", o->directory, "where the folder is made")->type_name("FOLDER")->capture_default_str();
  sub->callback([o] { create(o->name, o->directory); });
}

}  // namespace dyn::tool
