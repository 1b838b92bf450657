// SPDX-License-Identifier: BSD-2-Clause
#include "volume_options.hpp"

#include "messages.hpp"

namespace dyn::tool {

CLI::Option* addPackages(CLI::App& app, std::vector<std::string>& packages) {
  return app
      .add_option("--package", packages, "folder of packages, or a package, for package:// (repeatable); then ROS_PACKAGE_PATH, AMENT_PREFIX_PATH")
      ->type_name("FOLDER");
}

void VolumeOptions::add(CLI::App& app) {
  app.add_option("--scene", scene, "a URDF whose volumes stand in the world")->type_name("FILE");
  addPackages(app, packages);
  app.add_flag("--skip-missing", skip_missing, "leave out volumes whose files are not there");
  app.add_option("--narrow", narrow, "the functions that compare two volumes: libdyn's own, or FCL's")
      ->check(CLI::IsMember({"own", "fcl"}))
      ->capture_default_str();
  app.add_option("--fcl-tolerance", fcl_tolerance, "of --narrow fcl [m]")->default_str(CLI::detail::to_string(GeometryOptions{}.fcl_tolerance));
}

Model VolumeOptions::description(const ModelOptions& robot) const {
  Model description = robot.read();
  if (!scene.empty()) description = append(description, timed("read " + scene, [&] { return load(scene); }), "universe", {}, "scene/");
  printNotes(description);
  return description;
}

GeometryOptions VolumeOptions::geometry() const {
  GeometryOptions options;
  options.packages = packages;
  options.missing = skip_missing ? GeometryOptions::Missing::skip : GeometryOptions::Missing::refuse;
  options.narrow = narrow == "fcl" ? GeometryOptions::Narrow::fcl : GeometryOptions::Narrow::own;
  if (fcl_tolerance && options.narrow != GeometryOptions::Narrow::fcl) throw CLI::ValidationError("--fcl-tolerance", "needs --narrow fcl");
  if (fcl_tolerance) options.fcl_tolerance = *fcl_tolerance;
  return options;
}

}  // namespace dyn::tool
