// SPDX-License-Identifier: BSD-2-Clause
// dyn completion: scripts by which bash, zsh and fish complete subcommands, options, their values and files.
#include "command_table.hpp"
#include "commands.hpp"
#include "text.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace dyn::tool {

namespace {

std::string joined(const std::vector<std::string>& words) { return CLI::detail::join(words, " "); }

/// Returns "FILE", "FOLDER", the values of an argument, or "-" if bash has nothing to offer for it.
std::string bashKind(const OptionEntry& option) {
  return option.takes_files ? "FILE" : option.takes_folders ? "FOLDER" : option.values.empty() ? "-" : joined(option.values);
}

const char* const bash_code = R"(
_dyn() {
  local cur=${COMP_WORDS[COMP_CWORD]} command=dyn option='' kind='' list='' word i
  COMPREPLY=()
  # Bash splits --option=value into three words.
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if [[ $word == = ]]; then
      continue
    elif [[ -n $option ]]; then
      option=
    elif [[ $word == -* ]]; then
      [[ -z $(_dyn_argument "$command" "$word") ]] || option=$word
    elif [[ " $(_dyn_subcommands "$command") " == *" $word "* ]]; then
      command+=" $word"
    fi
  done
  [[ $cur != = ]] || cur=
  if [[ -n $option ]]; then
    kind=$(_dyn_argument "$command" "$option")
  elif [[ $cur == -* ]]; then
    kind=$(_dyn_options "$command")
  else
    kind=$(_dyn_subcommands "$command")
    [[ -n $kind ]] || kind=$(_dyn_argument "$command" POSITIONAL)
  fi
  case $kind in
    FILE) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    FOLDER) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    -) ;;
    *)
      # In a list such as rnea,ab, complete the last word.
      [[ -z $option || $cur != *,* ]] || list=${cur%,*},
      mapfile -t COMPREPLY < <(compgen -P "$list" -W "$kind" -- "${cur##*,}")
      ;;
  esac
}
complete -F _dyn dyn
)";

std::string bashScript(const std::vector<CommandEntry>& table) {
  std::string subcommands, options, arguments;
  for (const CommandEntry& command : table) {
    if (!command.subcommands.empty()) subcommands += "    " + shellWord(command.path) + ") echo " + shellWord(joined(command.subcommands)) + " ;;\n";
    std::string names;
    for (const OptionEntry& option : command.options) {
      if (!option.names.empty()) names += (names.empty() ? "" : " ") + joined(option.names);
      if (option.argument.empty()) continue;
      std::string patterns;
      for (const std::string& name : option.names) patterns += (patterns.empty() ? "" : " | ") + shellWord(command.path + " " + name);
      if (option.names.empty()) patterns = shellWord(command.path + " POSITIONAL");
      arguments += "    " + patterns + ") echo " + shellWord(bashKind(option)) + " ;;\n";
    }
    options += "    " + shellWord(command.path) + ") echo " + shellWord(names) + " ;;\n";
  }
  const auto table_of = [](const std::string& name, const std::string& key, const std::string& lines) {
    return name + "() {\n  case " + key + " in\n" + lines + "  esac\n}\n";
  };
  return "# bash completion for dyn, written by `dyn completion bash`.\n" + table_of("_dyn_subcommands", "$1", subcommands) +
         table_of("_dyn_options", "$1", options) + table_of("_dyn_argument", "\"$1 $2\"", arguments) + bash_code;
}

/// The text of a description within a specification of zsh's _arguments.
std::string zshText(std::string text) {
  for (const char* special : {"\\", "[", "]", ":"}) text = replaced(text, special, std::string("\\") + special);
  return text;
}

std::string zshAction(const OptionEntry& option) {
  if (option.takes_files) return "_files";
  if (option.takes_folders) return "_files -/";
  if (option.values.empty()) return "";
  return option.list ? "_values -s , value " + joined(option.values) : "(" + joined(option.values) + ")";
}

std::string zshFunction(const std::string& path) { return "_" + replaced(path, " ", "_"); }

std::string zshScript(const std::vector<CommandEntry>& table) {
  std::string out = "#compdef dyn\n# zsh completion for dyn, written by `dyn completion zsh`.\n";
  for (const CommandEntry& command : table) {
    out += "\n" + zshFunction(command.path) + "() {\n";
    std::string specifications;
    int positional = 0;
    for (const OptionEntry& option : command.options) {
      const std::string argument = ":" + zshText(option.argument) + ":" + zshAction(option);
      if (option.names.empty()) {
        specifications += " \\\n    " + shellWord((option.list ? "*" : std::to_string(++positional)) + argument);
        continue;
      }
      for (const std::string& name : option.names) {
        const bool attached = !option.argument.empty() && name.starts_with("--");
        specifications += " \\\n    " + shellWord((option.list ? "*" : "") + name + (attached ? "=" : "") + "[" + zshText(option.summary) + "]" +
                                                  (option.argument.empty() ? "" : argument));
      }
    }
    if (command.subcommands.empty()) {
      out += "  _arguments" + specifications + "\n}\n";
      continue;
    }
    out += "  local -a commands=(";
    for (const std::string& name : command.subcommands) {
      out += "\n    " + shellWord(name + ":" + commandAt(table, command.path + " " + name).summary);
    }
    out += "\n  )\n  local curcontext=$curcontext state line\n  _arguments -C" + specifications +
           " \\\n    '1: :->command' '*:: :->rest'\n  case $state in\n    command) _describe subcommand commands ;;\n    rest)\n      case $words[1] "
           "in\n";
    for (const std::string& name : command.subcommands) out += "        " + name + ") " + zshFunction(command.path + " " + name) + " ;;\n";
    out += "      esac\n      ;;\n  esac\n}\n";
  }
  return out + "\n_dyn \"$@\"\n";
}

const char* const fish_code = R"(
function __dyn_at --description 'Whether the command line is at this command'
    set -l words (commandline -opc)
    set -l at dyn
    set -e words[1]
    for word in $words
        if contains -- "$at $word" $__dyn_commands
            set at "$at $word"
        end
    end
    test "$at" = "$argv"
end
complete -c dyn -f
)";

/// A word in single quotes, as fish reads it.
std::string fishWord(const std::string& text) { return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'"; }

std::string fishArgument(const OptionEntry& option) {
  if (option.takes_files) return " -r -F";
  if (option.takes_folders) return " -x -a '(__fish_complete_directories)'";
  if (option.values.empty()) return " -x";
  return " -x -a " + fishWord(option.list ? "(__fish_append , " + joined(option.values) + ")" : joined(option.values));
}

std::string fishScript(const std::vector<CommandEntry>& table) {
  std::string out = "# fish completion for dyn, written by `dyn completion fish`.\nset -g __dyn_commands", lines;
  for (const CommandEntry& command : table) {
    out += " " + fishWord(command.path);
    const std::string line = "complete -c dyn -n " + fishWord("__dyn_at " + command.path);
    const std::size_t space = command.path.rfind(' ');
    if (space != std::string::npos)
      lines += "complete -c dyn -n " + fishWord("__dyn_at " + command.path.substr(0, space)) + " -a " + command.path.substr(space + 1) + " -d " +
               fishWord(command.summary) + "\n";
    for (const OptionEntry& option : command.options) {
      lines += line;
      for (const std::string& name : option.names) lines += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (option.names.empty()) {
        lines += option.takes_files ? " -F\n" : " -a " + fishWord(joined(option.values)) + "\n";
      } else {
        lines += (option.argument.empty() ? "" : fishArgument(option)) + " -d " + fishWord(option.summary) + "\n";
      }
    }
  }
  return out + "\n" + fish_code + lines;
}

}  // namespace

void addCompletion(CLI::App& app) {
  CLI::App* sub = addCommand(app, "completion", "a script by which a shell completes dyn's subcommands, options, values and files");
  const auto shell = std::make_shared<std::string>();
  sub->add_option("SHELL", *shell, "the shell")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
  sub->callback([shell, &app] {
    const std::vector<CommandEntry> table = commandTable(app);
    std::fputs((*shell == "bash" ? bashScript(table) : *shell == "zsh" ? zshScript(table) : fishScript(table)).c_str(), stdout);
  });
}

}  // namespace dyn::tool
