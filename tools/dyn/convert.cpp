// SPDX-License-Identifier: BSD-2-Clause
// dyn convert: writes a model in libdyn's own format, which loses nothing, or as URDF with a report of what that cannot say.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>
#include <dyn/parsers/urdf.hpp>

#include <cstdio>
#include <memory>

namespace dyn::tool {

void addConvert(CLI::App& app) {
  CLI::App* sub = addCommand(app, "convert", "writes a model as .dyn.json, with nothing lost, or as .urdf, and says what that cannot hold");
  struct Options {
    ModelOptions model;
    std::string out;
  };
  auto o = std::make_shared<Options>();
  o->model.mimic = "coupled";  // other subcommands read a model as plain readers do; here nothing may be lost
  o->model.add(*sub);
  sub->add_option("OUT", o->out, "the file to write, NAME.dyn.json or NAME.urdf")
      ->type_name("FILE")
      ->required()
      ->check(fileName({".json", ".urdf"}, "models"));
  sub->callback([o] {
    checkReplaceable(o->out);
    const Model description = o->model.description();
    if (o->out.ends_with(".urdf")) {
      for (const std::string& lost : urdf::save(description, o->out)) warning("URDF cannot say " + lost);
    } else {
      json::save(description, o->out);
    }
    std::printf("wrote %zu bodies to %s\n", description.bodies.size() - 1, o->out.c_str());
  });
}

}  // namespace dyn::tool
