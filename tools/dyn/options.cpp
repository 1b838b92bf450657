// SPDX-License-Identifier: BSD-2-Clause
#include "options.hpp"

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

std::string refusal(const CLI::App* app, const CLI::Error& error) {
  std::string command = "dyn";
  while (!app->get_subcommands().empty()) {
    app = app->get_subcommands().front();
    command += " " + app->get_name();
  }
  return command + ": " + error.what() + "\n`" + command + " --help` tells how it is written\n";
}

}  // namespace dyn::tool
