// SPDX-License-Identifier: BSD-2-Clause
// dyn convert: writes a model in libdyn's own format, which loses nothing, or as URDF or MJCF with a report of what that cannot say.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "options.hpp"
#include "volume_options.hpp"

#include <dyn/file.hpp>
#include <dyn/geometry/embed.hpp>
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
  Save* save;      ///< returns what the format cannot say
  bool triangles;  ///< whether it has a place for the triangles of meshes
};
constexpr Target targets[] = {
    {".json", "JSON", saveJson, true}, {".urdf", "URDF", urdf::save, false}, {".xml", "MJCF", mjcf::save, true}, {".mjcf", "MJCF", mjcf::save, true}};

/// Puts the contents of the volumes' files into the description, and warns of those that stay files.
void embed(Model& description, const EmbedOptions& options) {
  const EmbedReport report = embedFiles(description, options);
  for (const std::string& volume : report.left) warning("not embedded: volume " + volume);
  std::printf("embedded %d files in %d volumes\n", report.files, report.volumes);
}

}  // namespace

void addConvert(CLI::App& app) {
  CLI::App* sub = addCommand(app, "convert", "writes a model as .dyn.json, with nothing lost, or as URDF or MJCF, and says what that cannot hold");
  struct Options {
    ModelOptions model;
    std::string out;
    bool embed = false;
    double largest_mesh = 1;
    std::vector<std::string> packages;
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
  CLI::Option* embed_meshes =
      sub->add_flag("--embed-meshes", o->embed, "write the contents of mesh and octree files into OUT, so that it needs no files (not for URDF)");
  sub->add_option("--largest-mesh", o->largest_mesh, "larger files are not embedded [MB]")
      ->check(CLI::Range(0.0, 512.0))
      ->capture_default_str()
      ->needs(embed_meshes);
  addPackages(*sub, o->packages)->needs(embed_meshes);
  sub->callback([o] {
    checkReplaceable(o->out);
    const Target& target = *std::find_if(std::begin(targets), std::end(targets), [&](const Target& t) { return o->out.ends_with(t.ending); });
    if (o->embed && !target.triangles) throw CLI::ValidationError("--embed-meshes", "URDF names meshes by files; write NAME.dyn.json or NAME.xml");
    Model description = o->model.description();
    if (o->embed) embed(description, {o->packages, static_cast<std::uintmax_t>(o->largest_mesh * 0x1p20)});
    for (const std::string& lost : target.save(description, o->out)) warning(std::string(target.format) + " cannot say " + lost);
    std::printf("wrote %zu bodies to %s\n", description.bodies.size() - 1, o->out.c_str());
  });
}

}  // namespace dyn::tool
