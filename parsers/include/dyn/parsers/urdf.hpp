// Robots from URDF. Reading checks everything that urdfdom lets pass; messages name file and line.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn::urdf {

enum class Mimic { coupled, independent };
enum class Order { name, file };
enum class Continuous { unit_circle, angle };
enum class Inertias { physical, any };

struct Options {
  std::string root = "fixed";                       ///< joint type between world and root link, e.g. "free_flyer"
  Mimic mimic = Mimic::coupled;                     ///< obey <mimic>, or leave those joints independent
  Order order = Order::name;                        ///< siblings sorted by joint name (as urdfdom and Pinocchio) or as in the file
  Continuous continuous = Continuous::unit_circle;  ///< q = (cos, sin), or one unbounded angle
  Inertias inertias = Inertias::physical;           ///< refuse inertias that are not positive semi-definite, or note them
};

/// Reads a robot. Root link's joint is called "root_joint", with _ behind it while the file has a joint of that name; every link is a body; fixed
/// joints stay joints of type "fixed".
/// Throws Error(file | syntax | model).
DYN_API Model load(const std::string& path, const Options& options = {});
/// The same from text; `name` stands for the file in messages.
DYN_API Model parse(const std::string& text, const std::string& name, const Options& options = {});

/// All that is wrong with a file, where load() stops at the first; empty if it loads.
DYN_API std::vector<Error> check(const std::string& path, const Options& options = {});

}  // namespace dyn::urdf
