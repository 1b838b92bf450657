// SPDX-License-Identifier: BSD-2-Clause
// Plugins of traced joint types: compiled into the cache, or as a folder that CMake builds.
#include "codegen/compiler.hpp"
#include "traced_joint/traced_joint.hpp"
#include "trusted_file.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>
#include <dyn/version.hpp>

#include <algorithm>

namespace dyn {

namespace {

namespace fs = std::filesystem;

// In all these texts, @NAME@ stands for the type.
const char* const cmake_text = R"(cmake_minimum_required(VERSION 3.25)
project(@NAME@ LANGUAGES CXX)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_package(libdyn REQUIRED COMPONENTS sdk)
libdyn_add_joint_plugin(@NAME@ @NAME@.cpp)
)";

const char* const readme_text = R"(# @NAME@

A joint type for libdyn. Build it against an installed libdyn, check it, use it:

    cmake -S . -B build -DCMAKE_PREFIX_PATH=/where/libdyn/is/installed && cmake --build build
    dyn plugin check build/@NAME@.so
    DYN_PLUGIN_PATH=$PWD/build dyn info @NAME@.urdf

`@NAME@.cpp` is the joint: its name, the parameters it takes, its pose as a function of q. `@NAME@.urdf` is a robot that has one.
)";

// @TYPE@ and @LIMIT@ are what programs without libdyn see.
const char* const urdf_text = R"(<?xml version="1.0"?>
<robot name="@NAME@">
  <link name="base"/>
  <link name="follower">
    <inertial>
      <origin xyz="0 0 0.05"/>
      <mass value="0.5"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/>
    </inertial>
  </link>
  <!-- What programs without libdyn see; libdyn takes type and parameters from the extension below. -->
  <joint name="lift" type="@TYPE@">
    <parent link="base"/>
    <child link="follower"/>@LIMIT@
  </joint>
  <libdyn>
    <!-- The armature is the inertia of what turns or slides in the joint itself. Without one nothing resists where the follower stands still. -->
    <joint name="lift" type="@NAME@"@ATTRIBUTES@ armature="@ARMATURE@"/>
  </libdyn>
</robot>
)";
const char* const limit_text = R"(
    <axis xyz="0 0 1"/>
    <limit lower="-3.2" upper="3.2" effort="100" velocity="10"/>)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

/// The folder of the headers that belong to this library: include/ beside lib/, or beside the folder that has lib/ARCHITECTURE/.
std::string ownHeaders() {
  const fs::path lib = libraryFile().parent_path();
  std::error_code error;
  for (const fs::path& include : {lib.parent_path() / "include", lib.parent_path().parent_path() / "include"})
    if (fs::exists(include / "dyn_sdk" / "joint_plugin.hpp", error)) return include.string();
  throw Error(ErrorCode::file,
              "no dyn_sdk/joint_plugin.hpp belongs to this library; install libdyn's headers, or name their folder (JointPluginOptions::headers)",
              {(lib.parent_path() / "include").string(), 0, ""});
}

/// The text of all headers that a plugin includes.
std::string headerTexts(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const char* part : {"dyn_sdk", "dyn/joint", "dyn/scalar", "dyn/spatial"}) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder / part, error))
      if (entry.is_regular_file(error)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::string out;
  for (const fs::path& file : files) out += readFile(file.string());
  return out;
}

/// The compiler's option for the instruction set of the kernels in use.
std::vector<std::string> processorFlags() {
  const std::string set = version().instruction_set;
  if (set == "avx512") return {"-march=x86-64-v4", "-ffp-contract=fast", "-Wno-uninitialized", "-Wno-maybe-uninitialized"};
  if (set == "avx2") return {"-march=x86-64-v3", "-ffp-contract=fast"};
  return {};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> pluginFolder(const std::string& name, const std::string& source, const std::string& attributes,
                                                              int nv) {
  checkTypeName(name);
  std::string urdf = replaced(replaced(urdf_text, "@TYPE@", nv == 1 ? "prismatic" : "floating"), "@LIMIT@", nv == 1 ? limit_text : "");
  std::string armature = "0.001";
  for (int k = 1; k < nv; ++k) armature += " 0.001";
  urdf = replaced(replaced(urdf, "@ARMATURE@", armature), "@ATTRIBUTES@", attributes.empty() ? "" : " " + attributes);
  return {{"CMakeLists.txt", replaced(cmake_text, "@NAME@", name)},
          {name + ".cpp", source},
          {"README.md", replaced(readme_text, "@NAME@", name)},
          {name + ".urdf", replaced(urdf, "@NAME@", name)}};
}

std::vector<std::pair<std::string, std::string>> pluginFolder(const TracedJoint& joint) {
  std::string attributes;
  for (const TracedParameter& p : joint.parameters) attributes += (attributes.empty() ? "" : " ") + p.name + "=\"" + exampleOf(p) + "\"";
  return pluginFolder(joint.name, writeJointSource(joint), attributes, joint.nv);
}

std::string compileJointPlugin(const TracedJoint& joint, const JointPluginOptions& options) {
  const std::string headers = options.headers.empty() ? ownHeaders() : options.headers;
  CompilerTask task{.what = "joint type '" + joint.name + "'",
                    .prefix = joint.name + "-",
                    .source = writeJointSource(joint),
                    .file = joint.name + ".cpp",
                    .words = compilerCommand(options.compiler, "CXX", "c++"),
                    .flags = {"-std=c++20", "-O3", "-DNDEBUG", "-shared", "-fPIC", "-fvisibility=hidden", "-fvisibility-inlines-hidden",
                              "-fno-math-errno", "-fno-trapping-math"},
                    .identity = headerTexts(headers),
                    .seconds = options.seconds,
                    .remedy = "allow more (JointPluginOptions::seconds)"};
  for (const std::string& flag : processorFlags()) task.flags.push_back(flag);
  task.flags.insert(task.flags.end(), {"-I", headers});
  const ObjectCache cache(options.cache);
  const std::string entry = entryName(task);
  const std::optional<OpenFile> found = cache.find(entry);
  return found ? found->path() : compileInto(cache, entry, task).path();
}

}  // namespace dyn
