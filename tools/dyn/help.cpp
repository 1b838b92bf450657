// SPDX-License-Identifier: BSD-2-Clause
// dyn help: the help of a subcommand on standard output, or a manual page for each.
#include "command_table.hpp"
#include "commands.hpp"
#include "folder.hpp"
#include "options.hpp"

#include <dyn/file.hpp>
#include <dyn/near_names.hpp>
#include <dyn/version.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>

namespace dyn::tool {

namespace {

/// The text as troff prints it: hyphens that can be copied, and no line that is taken for a request.
std::string troff(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  return out.starts_with('.') || out.starts_with('\'') ? "\\&" + out : out;
}

std::string pageName(const std::string& path) {
  std::string name = path;
  std::replace(name.begin(), name.end(), ' ', '-');
  return name;
}

std::string manualOf(const OptionEntry& option) {
  std::string head;
  for (const std::string& name : option.names) head += (head.empty() ? "" : ", ") + ("\\fB" + troff(name) + "\\fR");
  if (!option.argument.empty()) head += (head.empty() ? "" : " ") + ("\\fI" + troff(option.argument) + "\\fR");
  std::string text = troff(option.summary);
  if (!option.rule.empty()) text += " (" + troff(option.rule) + ")";
  if (!option.values.empty()) text += "; one of " + troff(CLI::detail::join(option.values, ", "));
  if (!option.default_value.empty()) text += "; by default " + troff(option.default_value);
  return ".TP\n" + head + "\n" + text + "\n";
}

const char* const ends = R"(.SH "EXIT STATUS"
.TP
0
The command has done its work.
.TP
1
The model, the data or the answer is wrong, or output was lost.
.TP
2
The command line is wrong.
.TP
130, 143
Ctrl\-C or SIGTERM ended the command. It has written the results that were complete. The commands codegen and truth write all files or none.
.SH ENVIRONMENT
.TP
DYN_PLUGIN_PATH
Folders of joint plugins, separated by colons.
.TP
DYN_SIMD
The instruction set to use: scalar, sse2, avx2 or avx512.
.TP
CC
The C compiler for generated code, with its first arguments if it needs any. The default is cc.
.TP
LIBDYN_CACHE
The folder of compiled functions. The default is libdyn in XDG_CACHE_HOME, or else in ~/.cache.
.TP
ROS_PACKAGE_PATH, AMENT_PREFIX_PATH
Folders, separated by colons, where meshes with package:// in their names are looked for.
.TP
NO_COLOR
If it is set, nothing is coloured unless \fB\-\-color\fR asks for it.
.TP
TERM
If it is dumb, nothing is coloured and no progress is shown.
)";

std::string manualPage(const CommandEntry& command, const std::vector<CommandEntry>& table) {
  const std::string name = troff(pageName(command.path));
  std::string title = pageName(command.path), synopsis = "\\fB" + troff(command.path) + "\\fR [\\fIOPTION\\fR]...", also;
  std::transform(title.begin(), title.end(), title.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  std::vector<std::pair<std::string, std::string>> groups;  // a heading, and the options below it
  for (const OptionEntry& option : command.options) {
    if (option.names.empty()) synopsis += (option.required ? " \\fI" : " [\\fI") + troff(option.argument) + (option.required ? "\\fR" : "\\fR]");
    const std::string group = option.names.empty() ? "Arguments" : option.group;
    auto found = std::find_if(groups.begin(), groups.end(), [&](const auto& known) { return known.first == group; });
    if (found == groups.end()) found = groups.insert(groups.end(), {group, ""});
    found->second += manualOf(option);
  }
  std::string out = ".TH \"" + troff(title) + "\" 1 \"\" \"libdyn " + version().number + "\" \"User Commands\"\n.SH NAME\n" + name + " \\- " +
                    troff(command.summary) + "\n.SH SYNOPSIS\n" + synopsis + (command.subcommands.empty() ? "" : " \\fISUBCOMMAND\\fR ...") + "\n";
  if (!command.subcommands.empty()) out += ".SH SUBCOMMANDS\n";
  for (const std::string& sub : command.subcommands) {
    const std::string path = command.path + " " + sub;
    out += ".TP\n\\fB" + troff(sub) + "\\fR\n" + troff(commandAt(table, path).summary) + "; see \\fB" + troff(pageName(path)) + "\\fR(1)\n";
  }
  for (auto& [heading, options] : groups) {
    std::transform(heading.begin(), heading.end(), heading.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
    out += ".SH \"" + heading + "\"\n" + options;
  }
  const std::size_t space = command.path.rfind(' ');
  if (space == std::string::npos) return out + ends;
  return out + ".SH \"SEE ALSO\"\n\\fB" + troff(pageName(command.path.substr(0, space))) + "\\fR(1)\n";
}

struct HelpOptions {
  std::vector<std::string> command;
  bool manual = false;
  std::string pages;
};

void run(const HelpOptions& o, const CLI::App& root) {
  const std::vector<CommandEntry> table = commandTable(root);
  if (!o.pages.empty()) {
    makeFolder(o.pages);
    for (const CommandEntry& command : table) replaceFile(o.pages + "/" + pageName(command.path) + ".1", manualPage(command, table));
    return;
  }
  const CLI::App* app = &root;
  std::string path = root.get_name();
  for (const std::string& word : o.command) {
    const std::vector<std::string>& names = commandAt(table, path).subcommands;
    if (std::find(names.begin(), names.end(), word) == names.end())
      throw CLI::ValidationError("COMMAND", "'" + path + "' has no subcommand '" + word + "'" + nearNames(word, names));
    app = app->get_subcommand(word);
    path += " " + word;
  }
  // CLI::App::help() of dyn itself would print that of the subcommand in use, which is this one.
  std::fputs(
      o.manual ? manualPage(commandAt(table, path), table).c_str() : app->get_formatter()->make_help(app, path, CLI::AppFormatMode::Normal).c_str(),
      stdout);
}

}  // namespace

void addHelp(CLI::App& app) {
  CLI::App* sub = addCommand(app, "help", "the options of a subcommand");
  const auto o = std::make_shared<HelpOptions>();
  sub->add_option("COMMAND", o->command, "the subcommand, such as simulate or plugin check; without it dyn itself");
  CLI::Option* manual = sub->add_flag("--man", o->manual, "as a manual page for man -l");
  sub->add_option("--man-pages", o->pages, "write the manual pages of all subcommands to this folder")
      ->type_name("FOLDER")
      ->check(fileName())
      ->excludes(manual);
  sub->callback([o, &app] { run(*o, app); });
}

}  // namespace dyn::tool
