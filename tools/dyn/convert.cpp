// SPDX-License-Identifier: BSD-2-Clause
// dyn convert: writes a model in libdyn's own format, which loses nothing, or as URDF or MJCF with a report of what that cannot say.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/mjcf.hpp>
#include <dyn/parsers/urdf.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>

namespace dyn::tool {

namespace {

using Save = std::vector<std::string>(const Model& model, const std::string& path);

std::vector<std::string> saveJson(const Model& model, const std::string& path) {
  json::save(model, path);
  return {};
}

/// A format that can be written.
struct Target {
  const char *ending, *format;
  Save* save;  ///< returns what the format cannot say
};
constexpr Target targets[] = {
    {".json", "JSON", saveJson}, {".urdf", "URDF", urdf::save}, {".xml", "MJCF", mjcf::save}, {".mjcf", "MJCF", mjcf::save}};

}  // namespace

void addConvert(CLI::App& app) {
  CLI::App* sub = addCommand(app, "convert", "writes a model as .dyn.json, with nothing lost, or as URDF or MJCF, and says what that cannot hold");
  struct Options {
    ModelOptions model;
    std::string out;
  };
  auto o = std::make_shared<Options>();
  o->model.mimic = "coupled";  // other subcommands read a model as plain readers do; here nothing may be lost
  o->model.add(*sub);
  std::vector<std::string> endings;
  for (const Target& target : targets) endings.emplace_back(target.ending);
  sub->add_option("OUT", o->out, "the file to write: NAME.dyn.json, NAME.urdf, or NAME.xml or NAME.mjcf for MJCF")
      ->type_name("FILE")
      ->required()
      ->check(fileName(endings, "models"));
  sub->callback([o] {
    checkReplaceable(o->out);
    const Model description = o->model.description();
    const Target& target = *std::find_if(std::begin(targets), std::end(targets), [&](const Target& t) { return o->out.ends_with(t.ending); });
    for (const std::string& lost : target.save(description, o->out)) warning(std::string(target.format) + " cannot say " + lost);
    std::printf("wrote %zu bodies to %s\n", description.bodies.size() - 1, o->out.c_str());
  });
}

}  // namespace dyn::tool
