// SPDX-License-Identifier: BSD-2-Clause
#include "scene.hpp"
#include "vocabulary.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/mjcf.hpp>

#include <cstring>

namespace dyn::mjcf {

namespace {

/// Errors beyond these are not collected.
constexpr std::size_t most_errors = 1000;

/// Reads a model and adds all errors to a list. The model is usable only if there are none.
Model read(const std::string& text, const std::string& name, const LoadOptions& options, std::vector<Error>& errors) {
  const Guard guard = [&](const std::function<void()>& step) {
    try {
      if (errors.size() < most_errors) step();
    } catch (const Error& e) {
      errors.push_back(e);
    }
  };
  const Source source(text, name, options.files);
  const Settings settings = readSettings(source);
  const Defaults defaults(source);
  Meshes meshes(source, settings);
  xml::Notes notes;
  const Context context{source, settings, defaults, meshes, notes};
  const DefaultClass& main = defaults.find("", source.root());
  source.forEach(source.root(), [&](const XMLElement& asset) {
    if (std::strcmp(asset.Name(), "asset") != 0) return;
    source.forEach(asset, [&](const XMLElement& e) {
      if (std::strcmp(e.Name(), "mesh") == 0) guard([&] { meshes.add(defaults.of(e, main)); });
    });
  });
  Scene scene = readScene(context, options, guard);
  if (errors.empty()) readRelations(context, scene, guard);
  if (errors.empty()) readDevices(context, scene, guard);
  if (errors.empty()) readKeyframes(context, scene, guard);
  noteUnread(source, notes);
  Model model = std::move(scene.model);
  for (const auto& remarks : {source.notes(), notes.lines(name)}) model.notes.insert(model.notes.end(), remarks.begin(), remarks.end());
  return model;
}

}  // namespace

Model parse(const std::string& text, const std::string& name, const LoadOptions& options) {
  std::vector<Error> errors;
  Model model = read(text, name, options, errors);
  if (!errors.empty()) throw errors.front();
  return model;
}

Model load(const std::string& path, const LoadOptions& options) { return parse(readFile(path, xml::largest_file), path, options); }

std::vector<Error> check(const std::string& path, const LoadOptions& options) {
  std::vector<Error> errors;
  try {
    read(readFile(path, xml::largest_file), path, options, errors);
  } catch (const Error& e) {
    errors.push_back(e);
  }
  return errors;
}

}  // namespace dyn::mjcf
