// SPDX-License-Identifier: BSD-2-Clause
// Joint types from expression graphs. A program that has a joint's pose as a graph writes it as the source of a plugin, or compiles and loads it.
#pragma once

#include <dyn/codegen/graph.hpp>
#include <dyn/joint/joint_type.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dyn {

/// A parameter of a traced joint type.
struct TracedParameter {
  std::string name,           ///< as ParameterSpec::name
      unit,                   ///< its unit, "" if it has none
      help;                   ///< its meaning
  int size = 1;               ///< how many numbers it has
  std::vector<double> usual;  ///< its value where a model leaves it out; empty if a model must give it
};

/// The configuration space of a traced joint type for which q (+) v is not the sum q + v. The inputs of each graph are its arguments, one after the
/// other; c are the numbers of all parameters.
struct TracedSpace {
  Graph neutral,               ///< (c) -> q where the joint is "at zero"
      integrate,               ///< (q, v, c) -> q (+) v, where the joint is after one second of v
      difference,              ///< (q0, q1, c) -> the v with q0 (+) v = q1
      normalize;               ///< (q, c) -> q brought back onto the configuration space
  std::optional<Graph> rates;  ///< (q, v, c) -> dq/dt; without it, this is derived from `integrate`
};

/// A joint type whose functions were traced, so they have no branches.
struct TracedJoint {
  std::string name,                         ///< as JointTypeInfo::name, and an identifier of C++
      summary;                              ///< one line for people
  std::vector<TracedParameter> parameters;  ///< the schema
  int nq = 1,                               ///< number of coordinates
      nv = 1;                               ///< number of degrees of freedom
  Graph pose;                               ///< (q, c) -> 12 numbers: the rotation row after row, then the position
  std::optional<TracedSpace> space;         ///< without it, q (+) v = q + v
};

/// Returns the C++ source of a plugin with this type, which needs dyn_sdk/joint_plugin.hpp only. Deterministic. Throws Error(argument) for names that
/// C++ does not allow, for sizes out of range, and for graphs whose numbers of inputs or outputs do not fit.
DYN_API std::string writeJointSource(const TracedJoint& joint);

/// Returns the files of a folder from which CMake builds a plugin of one joint type: names and texts of CMakeLists.txt, NAME.cpp, README.md and
/// NAME.urdf, a robot that has one. `attributes` are the joint's attributes there, such as `h="0.1"`. Throws Error(argument) unless `name` is an
/// identifier of C++.
DYN_API std::vector<std::pair<std::string, std::string>> pluginFolder(const std::string& name, const std::string& source,
                                                                      const std::string& attributes, int nv = 1);
/// The same for a traced type.
DYN_API std::vector<std::pair<std::string, std::string>> pluginFolder(const TracedJoint& joint);

/// Returns the name of a C++ class for a type: CamFollowerJoint for cam_follower.
DYN_API std::string jointClassName(const std::string& name);

/// How plugins are compiled.
struct JointPluginOptions {
  std::string cache{};     ///< folder of compiled plugins; empty means the one of NativeOptions::cache
  std::string compiler{};  ///< a program; empty means the words of $CXX, else c++
  std::string headers{};   ///< folder of dyn_sdk/ and dyn/; empty means the one that belongs to the library
  double seconds = 120;    ///< a compiler that runs longer is stopped
};
/// Compiles a joint type for this processor and returns the path of the plugin, which JointRegistry::load() takes. The cache and its rules are those
/// of compileNative(). Throws as writeJointSource(), Error(compiler) if there is no compiler, it fails or takes too long, and Error(file) if there
/// are no headers or the cache cannot be used.
DYN_API std::string compileJointPlugin(const TracedJoint& joint, const JointPluginOptions& options = {});

/// Returns a type that evaluates the graphs one operation at a time, for machines without a compiler. It is ten to a hundred times as slow as a
/// plugin, and a thread's first call allocates. It lives until the process ends. Throws as writeJointSource().
DYN_API const JointType& interpretJoint(const TracedJoint& joint);

}  // namespace dyn
