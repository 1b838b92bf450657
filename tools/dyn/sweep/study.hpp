// SPDX-License-Identifier: BSD-2-Clause
// A study: the JSON file that says what a sweep computes. Its members are the options of the task's own subcommand, with _ for -, and what varies.
#pragma once

#include "motion_options.hpp"

#include <json/value.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace dyn::tool::sweep {

enum class TaskKind { simulate, compute, collide, python };

struct Study {
  std::string name;    ///< the file, for messages
  std::string folder;  ///< paths in the study are relative to it
  nlohmann::json document;
  TaskKind task = TaskKind::simulate;
  std::int64_t samples = 0;  ///< 0: as many as lists and grids have cells
  std::uint64_t seed = 0;
  std::int64_t chunk = 0;                      ///< samples of a chunk; 0: chosen by how long samples take
  MotionOptions options;                       ///< of which compute and collide use some
  bool effort_limits = false;                  ///< of simulate: torques are clipped at the limits of effort
  double every = 0;                            ///< [s] between the states of a simulation; 0: a hundredth of its time, at least dt
  std::vector<std::string> functions, frames;  ///< of compute
  std::string file, function;                  ///< of python
  std::vector<std::string> keep;

  json::Value value() const { return {document, "", name}; }
  /// The model with the scene around it.
  Model description() const { return options.volumes.description(options); }
  bool keeps(const std::string& what) const;
};

/// Reads a study; "-" is standard input. Throws Error(file | syntax | argument), which names the member.
Study readStudy(const std::string& path);
/// Reads the text of a study.
Study parseStudy(const std::string& text, const std::string& name, const std::string& folder);

/// A finite number.
double finiteNumber(const json::Value& value);
/// Throws Error(syntax) with similar names.
[[noreturn]] void unknownName(const json::Value& value, const std::string& what, const std::string& name, const std::vector<std::string>& known);

}  // namespace dyn::tool::sweep
