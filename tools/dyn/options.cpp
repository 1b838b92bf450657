// SPDX-License-Identifier: BSD-2-Clause
#include "options.hpp"

#include "commands.hpp"
#include "messages.hpp"

#include <dyn/near_names.hpp>

#include <report/svg.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace dyn::tool {

namespace {

template <class Holds>
CLI::Validator number(Holds holds, const std::string& rule) {
  return {[holds, rule](const std::string& text) -> std::string {
            double x = 0;
            if (!CLI::detail::lexical_cast(text, x) || std::isnan(x)) return "'" + text + "' is no number";
            return std::isfinite(x) && holds(x) ? "" : text + " must be " + rule;
          },
          rule};
}

}  // namespace

CLI::Validator positive() {
  return number([](double x) { return x > 0; }, "positive");
}

CLI::Validator notNegative() {
  return number([](double x) { return x >= 0; }, "0 or more");
}

CLI::Validator inRange(double low, double high) {
  return number([low, high](double x) { return x >= low && x <= high; }, "in " + benchmark::shortNumber(low) + " to " + benchmark::shortNumber(high));
}

CLI::Validator fileName() {
  return {[](const std::string& name) { return name.empty() ? std::string("the file's name is empty") : std::string(); }, ""};
}

CLI::Validator fileName(const std::vector<std::string>& endings, const std::string& what) {
  return {[endings, what](const std::string& name) -> std::string {
            const std::string ending = std::filesystem::path(name).extension().string();
            if (name.empty()) return "the file's name is empty";
            if (ending.empty() && endings.size() == 1) return "";
            if (std::find(endings.begin(), endings.end(), ending) != endings.end()) return "";
            return what + " end in " + CLI::detail::join(endings, " or ") + ", and '" + name + "' does not";
          },
          ""};
}

void addNamedState(CLI::App& app, std::string& name, const std::string& other) {
  CLI::Option* option = app.add_option("--q", name, "named state of the model: home, or arm/home of a group; several with commas");
  option->type_name("STATE");
  if (!other.empty()) option->excludes(other);
}

namespace {

/// Returns what is wrong if a word of the command line is no subcommand or no option, with similar names or all names; otherwise an empty text.
std::string unknownWord(const CLI::App& app) {
  const std::vector<std::string> words = app.remaining();
  if (words.empty()) return "";
  std::vector<std::string> commands;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) commands.push_back(sub->get_name());
  if (!commands.empty() && !words.front().starts_with('-')) {
    const std::string near = nearNames(words.front(), commands);
    return "there is no subcommand '" + words.front() + "'" + (near.empty() ? "; there are " + CLI::detail::join(commands, ", ") : near);
  }
  const auto option = std::find_if(words.begin(), words.end(), [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
  if (option == words.end()) return "";
  std::vector<std::string> options;
  for (const CLI::Option* known : app.get_options())
    for (const std::string& name : known->get_lnames()) options.push_back("--" + name);
  const std::string name = option->substr(0, option->find('='));
  return "there is no option '" + name + "'" + nearNames(name, options);
}

}  // namespace

std::string refusal(const CLI::App* app, const CLI::Error& error) {
  std::string command = "dyn", unknown = unknownWord(*app);
  while (unknown.empty() && !app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    command += " " + app->get_name();
    unknown = unknownWord(*app);
  }
  const std::string word = styled(stderr, Style::error, "error:");
  return command + ": " + word + " " + (unknown.empty() ? error.what() : unknown) + "\n`" + command + " --help` shows the options\n";
}

void addMessageOptions(CLI::App& app) {
  MessageOptions& o = messageOptions();
  const char* const group = "Options of every subcommand";
  app.add_flag("-q,--quiet", o.quiet, "no notes, warnings and progress; errors stay")->group(group);
  app.add_flag("-v,--verbose", o.verbose, "tell what is loaded from where, and how long each step takes")->group(group);
  app.add_option("--color", o.color, "colours: auto means on terminals, unless NO_COLOR is set")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str()
      ->group(group);
  // The options may stand before the subcommand and after it, so that only dyn itself sees all of them.
  if (app.get_parent() == nullptr)
    app.parse_complete_callback([&o] {
      if (o.quiet && o.verbose) throw CLI::ExcludesError("--verbose", "--quiet");
    });
}

CLI::App* addCommand(CLI::App& app, const std::string& name, const std::string& summary) {
  CLI::App* sub = app.add_subcommand(name, summary);
  addMessageOptions(*sub);
  return sub;
}

}  // namespace dyn::tool
