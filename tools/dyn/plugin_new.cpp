// SPDX-License-Identifier: BSD-2-Clause
// dyn plugin new: writes a folder with a joint type to start from.
#include "folder.hpp"
#include "interrupt.hpp"
#include "plugin.hpp"
#include "text.hpp"

#include <dyn/error.hpp>
#include <dyn/file.hpp>
#include <dyn/joint/registry.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace dyn::tool {

namespace {

namespace fs = std::filesystem;

// In all these texts, @NAME@ stands for the type and @CLASS@ for the class.
const char* const cmake_text = R"(cmake_minimum_required(VERSION 3.25)
project(@NAME@ LANGUAGES CXX)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_package(libdyn REQUIRED COMPONENTS sdk)
libdyn_add_joint_plugin(@NAME@ @NAME@.cpp)
)";

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

const char* const readme_text = R"(# @NAME@

A joint type for libdyn. Build it against an installed libdyn, check it, use it:

    cmake -S . -B build -DCMAKE_PREFIX_PATH=/where/libdyn/is/installed && cmake --build build
    dyn plugin check build/@NAME@.so
    DYN_PLUGIN_PATH=$PWD/build dyn info @NAME@.urdf

`@NAME@.cpp` is the joint: its name, the parameters it takes, its pose as a function of q. `@NAME@.urdf` is a robot that has one.
)";

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
  <joint name="lift" type="prismatic">
    <parent link="base"/>
    <child link="follower"/>
    <axis xyz="0 0 1"/>
    <limit lower="-3.2" upper="3.2" effort="100" velocity="10"/>
  </joint>
  <libdyn>
    <!-- The cam itself turns: its inertia about its axis is the armature. Without one nothing resists q = 0, where the follower stands still. -->
    <joint name="lift" type="@NAME@" h="0.1" armature="0.001"/>
  </libdyn>
</robot>
)";

// Keywords of C and C++, which cannot be names.
constexpr std::array keywords{
    "alignas",   "alignof",  "and",      "and_eq",   "asm",          "auto",       "bitand",       "bitor",         "bool",
    "break",     "case",     "catch",    "char",     "char16_t",     "char32_t",   "char8_t",      "class",         "co_await",
    "co_return", "co_yield", "compl",    "concept",  "const",        "const_cast", "consteval",    "constexpr",     "constinit",
    "continue",  "decltype", "default",  "delete",   "do",           "double",     "dynamic_cast", "else",          "enum",
    "explicit",  "export",   "extern",   "false",    "float",        "for",        "friend",       "goto",          "if",
    "inline",    "int",      "long",     "mutable",  "namespace",    "new",        "noexcept",     "not",           "not_eq",
    "nullptr",   "operator", "or",       "or_eq",    "private",      "protected",  "public",       "register",      "reinterpret_cast",
    "requires",  "restrict", "return",   "short",    "signed",       "sizeof",     "static",       "static_assert", "static_cast",
    "struct",    "switch",   "template", "this",     "thread_local", "throw",      "true",         "try",           "typedef",
    "typeid",    "typename", "union",    "unsigned", "using",        "virtual",    "void",         "volatile",      "wchar_t",
    "while",     "xor",      "xor_eq"};

bool isIdentifier(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto fits = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), fits) &&
         std::find(keywords.begin(), keywords.end(), name) == keywords.end();
}

/// cam_follower -> CamFollowerJoint. The suffix avoids clashes with names of C++ and its library.
std::string className(const std::string& name) {
  std::string text;
  bool start = true;
  for (const char c : name) {
    if (c == '_') {
      start = true;
    } else {
      text += start ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      start = false;
    }
  }
  if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) text = "My" + text;
  return text + "Joint";
}

void writeFile(const fs::path& path, const std::string& text, const std::string& name) {
  replaceFile(path.string(), replaced(replaced(text, "@NAME@", name), "@CLASS@", className(name)));
}

void create(const std::string& name, const std::string& directory) {
  if (!isIdentifier(name))
    throw CLI::ValidationError("NAME", "'" + name + "' cannot name a joint type: use letters, digits and _, no digit first, no keyword of C++");
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
    writeFile(folder / "CMakeLists.txt", cmake_text, name);
    writeFile(folder / (name + ".cpp"), source_text, name);
    writeFile(folder / "README.md", readme_text, name);
    writeFile(folder / (name + ".urdf"), urdf_text, name);
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
