// SPDX-License-Identifier: BSD-2-Clause
#include "command_table.hpp"

#include <algorithm>

namespace dyn::tool {

namespace {

OptionEntry entryOf(const CLI::Option& option) {
  OptionEntry out;
  for (const std::string& name : option.get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) out.names.push_back("--" + name);
  // CLI11 writes a type and what is checked as TYPE:{value,value} or TYPE:rule.
  const std::string type = option.get_type_name();
  const std::size_t colon = type.find(':');
  out.argument = type.substr(0, colon);
  const std::string checked = colon == std::string::npos ? "" : type.substr(colon + 1);
  if (checked.size() > 2 && checked.front() == '{' && checked.back() == '}') {
    out.values = CLI::detail::split(checked.substr(1, checked.size() - 2), ',');
  } else {
    out.rule = checked;
  }
  out.takes_files = out.argument == "FILE";
  out.takes_folders = out.argument == "FOLDER";
  if (option.get_positional()) out.argument = option.get_name();
  if (option.get_items_expected_max() == 0) out.argument.clear();
  out.summary = option.get_description();
  out.default_value = option.get_default_str();
  out.group = option.get_group();
  out.required = option.get_required();
  out.list = option.get_items_expected_max() > 1;
  return out;
}

void add(const CLI::App& app, const std::string& before, std::vector<CommandEntry>& out) {
  CommandEntry entry;
  entry.path = before + app.get_name();
  entry.summary = app.get_description();
  for (const CLI::Option* option : app.get_options()) entry.options.push_back(entryOf(*option));
  const std::vector<const CLI::App*> subcommands = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* sub : subcommands) entry.subcommands.push_back(sub->get_name());
  const std::string inside = entry.path + " ";
  out.push_back(std::move(entry));
  for (const CLI::App* sub : subcommands) add(*sub, inside, out);
}

}  // namespace

std::vector<CommandEntry> commandTable(const CLI::App& root) {
  std::vector<CommandEntry> out;
  add(root, "", out);
  return out;
}

const CommandEntry& commandAt(const std::vector<CommandEntry>& table, const std::string& path) {
  return *std::find_if(table.begin(), table.end(), [&](const CommandEntry& entry) { return entry.path == path; });
}

}  // namespace dyn::tool
