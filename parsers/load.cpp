// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/parsers/load.hpp>

namespace dyn {

Model load(const std::string& path, const LoadOptions& options, ModelFormat format) {
  if (format == ModelFormat::by_name && path.ends_with(".xacro"))
    throw Error(ErrorCode::syntax, "is a xacro file, which makes a URDF; run `xacro " + path + " > robot.urdf` and load that", {path, 0, ""});
  if (format == ModelFormat::urdf || (format == ModelFormat::by_name && !path.ends_with(".json"))) return urdf::load(path, options);
  if (options.root != LoadOptions().root)
    throw Error(ErrorCode::argument, "has its own joint between world and robot, so that the root joint '" + options.root + "' does not apply",
                {path, 0, ""});
  return json::load(path);
}

}  // namespace dyn
