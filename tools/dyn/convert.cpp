// SPDX-License-Identifier: BSD-2-Clause
// dyn convert: writes a model in libdyn's own format, which loses nothing.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"

#include <dyn/file.hpp>
#include <dyn/parsers/json.hpp>

#include <cstdio>
#include <memory>

namespace dyn::tool {

void addConvert(CLI::App& app) {
  CLI::App* sub = addCommand(app, "convert", "writes a model in libdyn's own format, .dyn.json, with nothing lost");
  struct Options {
    ModelOptions model;
    std::string out;
  };
  auto o = std::make_shared<Options>();
  o->model.mimic = "coupled";  // other subcommands read a model as plain readers do; here nothing may be lost
  o->model.add(*sub);
  sub->add_option("OUT", o->out, "the file to write, NAME.dyn.json")->type_name("FILE")->required()->check(fileName({".json"}, "a model"));
  sub->callback([o] {
    checkReplaceable(o->out);
    const Model description = o->model.description();
    json::save(description, o->out);
    std::printf("wrote %zu bodies to %s\n", description.bodies.size() - 1, o->out.c_str());
  });
}

}  // namespace dyn::tool
