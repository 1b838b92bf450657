// SPDX-License-Identifier: BSD-2-Clause
#include "study.hpp"

#include <dyn/file.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <set>

namespace dyn::tool::sweep {

namespace {

constexpr std::uintmax_t largest_study = std::uintmax_t{1} << 26;
constexpr int deepest_study = 16;
constexpr std::int64_t most_samples = std::int64_t{1} << 40;

/// Parses JSON. Members that are given twice and deep nesting are errors.
nlohmann::json parseStrictly(const std::string& text, const std::string& name) {
  std::vector<std::set<std::string>> members;
  const auto look = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > deepest_study) throw Error(ErrorCode::syntax, "is nested deeper than " + std::to_string(deepest_study) + " levels", {name, 0, ""});
    if (event == Event::object_start) members.emplace_back();
    if (event == Event::object_end) members.pop_back();
    if (event == Event::key && !members.back().insert(parsed.get<std::string>()).second)
      throw Error(ErrorCode::syntax, "has the member '" + parsed.get<std::string>() + "' twice in one object", {name, 0, ""});
    return true;
  };
  try {
    return nlohmann::json::parse(text, look);
  } catch (const nlohmann::json::exception& e) {
    throw Error(ErrorCode::syntax, std::string("is not JSON: ") + e.what(), {name, 0, ""});
  }
}

std::int64_t wholeNumber(const json::Value& value, std::int64_t least, std::int64_t most) {
  const nlohmann::json& x = value.json();
  if (!x.is_number_integer() || (x.is_number_unsigned() && x.get<std::uint64_t>() > static_cast<std::uint64_t>(most)) ||
      x.get<std::int64_t>() < least || x.get<std::int64_t>() > most)
    value.fail("must be a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return x.get<std::int64_t>();
}

std::vector<std::string> texts(const json::Value& value) {
  std::vector<std::string> out;
  value.each([&](const json::Value& entry) { out.push_back(entry.text()); });
  return out;
}

TaskKind taskOf(const json::Value& value) {
  const std::string name = value.text();
  const std::vector<std::string> names{"simulate", "compute", "collide", "python"};
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) unknownName(value, "task", name, names);
  return static_cast<TaskKind>(found - names.begin());
}

/// The member of a study that stands for an option of the command line.
std::string memberOf(const CLI::Option& option) {
  std::string name = option.get_positional() ? "model" : option.get_lnames().front();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::string pathOf(const std::string& text, const std::string& folder) { return (std::filesystem::path(folder) / text).lexically_normal().string(); }

/// A value as a word of the command line.
std::string wordOf(const json::Value& value, const CLI::Option& option, const std::string& folder) {
  const nlohmann::json& x = value.json();
  if (x.is_number()) return x.dump();
  const std::string text = value.text(), type = option.get_type_name();
  const bool path = type.starts_with("FILE") || type.starts_with("FOLDER");
  return path && !text.empty() ? pathOf(text, folder) : text;
}

/// The message with the names of members in place of those of options.
std::string withMembers(std::string text, const CLI::App& app) {
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames())
      for (std::size_t at; (at = text.find("--" + name)) != std::string::npos;) text.replace(at, name.size() + 2, memberOf(*option));
  if (const std::size_t at = text.find("MODEL"); at != std::string::npos) text.replace(at, 5, "model");
  return text;
}

/// Hands the members that are options to the parser of the command line, which knows their choices and ranges.
void readOptions(Study& study, const std::vector<std::string>& own) {
  CLI::App app("", "study");
  app.set_help_flag();
  switch (study.task) {
    case TaskKind::simulate:
      study.options.add(app);
      break;
    case TaskKind::collide:
      study.options.volumes.add(app);
      [[fallthrough]];
    case TaskKind::compute:
    case TaskKind::python:
      study.options.ModelOptions::add(app);
  }
  std::vector<std::string> words, known = own;
  for (const CLI::Option* option : app.get_options()) known.push_back(memberOf(*option));
  for (const auto& [member, unused] : study.document.items()) {
    if (std::find(known.begin(), known.end(), member) == known.end()) unknownName(study.value(), "member", member, known);
    const json::Value value = study.value()[member.c_str()];
    for (const CLI::Option* option : app.get_options()) {
      if (memberOf(*option) != member) continue;
      const std::string prefix = option->get_positional() ? "" : "--" + option->get_lnames().front() + "=";
      if (option->get_items_expected_max() == 0) {
        if (value.boolean()) words.push_back("--" + option->get_lnames().front());
      } else if (value.json().is_array() && option->get_items_expected_max() > 1) {
        value.each([&](const json::Value& entry) { words.push_back(prefix + wordOf(entry, *option, study.folder)); });
      } else {
        words.push_back(prefix + wordOf(value, *option, study.folder));
      }
    }
  }
  std::reverse(words.begin(), words.end());  // as the parser takes them
  try {
    app.parse(words);
  } catch (const CLI::Error& e) {
    throw Error(ErrorCode::syntax, withMembers(e.what(), app), {study.name, 0, ""});
  }
}

}  // namespace

bool Study::keeps(const std::string& what) const { return std::find(keep.begin(), keep.end(), what) != keep.end(); }

double finiteNumber(const json::Value& value) {
  if (!value.json().is_number() || !std::isfinite(value.json().get<double>())) value.fail("must be a finite number");
  return value.json().get<double>();
}

void unknownName(const json::Value& value, const std::string& what, const std::string& name, const std::vector<std::string>& known) {
  const std::string near = nearNames(name, known);
  std::string all;
  for (const std::string& one : known) all += (all.empty() ? "; there are " : ", ") + one;
  value.fail("there is no " + what + " '" + name + "'" + (near.empty() && known.size() <= 40 ? all : near));
}

Study parseStudy(const std::string& text, const std::string& name, const std::string& folder) {
  Study study;
  study.name = name;
  study.folder = folder;
  study.document = parseStrictly(text, name);
  const json::Value all = study.value();
  if (!study.document.is_object()) all.fail("must be an object");
  study.task = taskOf(all["task"]);
  std::vector<std::string> own{"task", "samples", "seed", "chunk", "vary", "keep", "success", "histograms"};
  std::vector<std::string> keeps{"inputs"};
  if (study.task == TaskKind::simulate) {
    own.insert(own.end(), {"every", "effort_limits"});
    keeps.insert(keeps.end(), {"initial", "final", "extremes", "energy", "trajectory", "counts"});
  } else if (study.task == TaskKind::compute) {
    own.insert(own.end(), {"functions", "frames"});
  } else if (study.task == TaskKind::python) {
    own.insert(own.end(), {"file", "function"});
  }
  readOptions(study, own);
  if (all.has("samples")) study.samples = wholeNumber(all["samples"], 1, most_samples);
  if (all.has("seed")) study.seed = static_cast<std::uint64_t>(wholeNumber(all["seed"], 0, std::numeric_limits<std::int64_t>::max()));
  if (all.has("chunk")) study.chunk = wholeNumber(all["chunk"], 1, most_samples);
  if (all.has("effort_limits")) study.effort_limits = all["effort_limits"].boolean();
  if (all.has("every")) study.every = finiteNumber(all["every"]);
  if (study.every < 0) all["every"].fail("must be 0 or more");
  if (all.has("functions")) study.functions = texts(all["functions"]);
  if (all.has("frames")) study.frames = texts(all["frames"]);
  if (study.task == TaskKind::python) {
    study.file = pathOf(all["file"].text(), folder);
    study.function = all.has("function") ? all["function"].text() : "evaluate";
  }
  if (all.has("keep"))
    study.keep = texts(all["keep"]);
  else if (study.task == TaskKind::simulate)
    study.keep = {"final"};
  for (const std::string& what : study.keep)
    if (std::find(keeps.begin(), keeps.end(), what) == keeps.end()) unknownName(all["keep"], "result", what, keeps);
  return study;
}

Study readStudy(const std::string& path) {
  namespace fs = std::filesystem;
  if (path == "-") return parseStudy({std::istreambuf_iterator<char>(std::cin), {}}, "standard input", fs::current_path().string());
  return parseStudy(readFile(path, largest_study), path, fs::absolute(path).parent_path().string());
}

}  // namespace dyn::tool::sweep
