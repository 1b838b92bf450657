// SPDX-License-Identifier: BSD-2-Clause
// Options of every subcommand that reads a model: the file, its root joint, and how the file is read.
#pragma once

#include "python_model.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/load.hpp>

#include <CLI/CLI.hpp>

#include <memory>
#include <string>
#include <vector>

namespace dyn::tool {

struct ModelOptions {
  std::string path;
  std::string format;  ///< empty: by the file's ending or content
  std::string root = "fixed";
  std::string mimic = "independent";
  std::string order = "name";
  std::string continuous = "unit_circle";
  std::string inertia = "physical";
  std::string files = "beside";
  std::string versions = "known";
  std::string srdf;
  std::vector<std::string> plugins;
  std::vector<std::string> lock;
  bool losses = false;
  bool any_plugin = false;

  void add(CLI::App& app);
  JointRegistry registry() const;
  LoadOptions loadOptions() const;
  Model read() const;
  /// Returns all that is wrong with the file; empty if it can be read.
  std::vector<Error> problems() const;
  /// Reads the model and prints its notes.
  Model description() const;
  CompileOptions compileOptions() const;
  CompactModel compile(const Model& described, const JointRegistry& registry) const;
  CompactModel compile(const Model& described) const { return compile(described, registry()); }
  CompactModel compile() const { return compile(description()); }

 private:
  bool isPython() const;
  /// Returns the result of a Python file, which is run once.
  const PythonModel& python() const;
  mutable std::shared_ptr<const PythonModel> python_;
};

/// Prints the notes of the parser, unless --quiet was given.
void printNotes(const Model& description);

}  // namespace dyn::tool
