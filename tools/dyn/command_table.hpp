// SPDX-License-Identifier: BSD-2-Clause
// The command line as a table: the commands with their options, read from the parser's own description. Completion and manual pages are made from it.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

struct OptionEntry {
  std::vector<std::string> names;   ///< such as -q and --quiet; empty for a positional argument
  std::string argument;             ///< what it takes: FILE, FOLDER, INT, ..., the name of a positional argument, or empty for a flag
  std::vector<std::string> values;  ///< the values that it takes; empty if these are not a short list
  std::string rule;                 ///< the rule that its numbers obey, such as "positive"
  std::string summary;
  std::string default_value;  ///< its value if the option is not given
  std::string group;
  bool takes_files = false, takes_folders = false, required = false, list = false;
};

struct CommandEntry {
  std::string path;  ///< such as "dyn plugin check"
  std::string summary;
  std::vector<OptionEntry> options;
  std::vector<std::string> subcommands;  ///< their names
};

/// All commands; each comes before its subcommands.
std::vector<CommandEntry> commandTable(const CLI::App& root);
/// The command with this path, which must be in the table.
const CommandEntry& commandAt(const std::vector<CommandEntry>& table, const std::string& path);

}  // namespace dyn::tool
