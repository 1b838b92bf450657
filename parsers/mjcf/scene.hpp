// SPDX-License-Identifier: BSD-2-Clause
// The bodies, geoms and sites of a file, with the names by which other elements call them.
#pragma once

#include "body.hpp"

#include <dyn/model/model.hpp>

#include <functional>

namespace dyn::mjcf {

/// A body of the file. Its joints are carried by the bodies `first` to `last` of the model; `last` has the file's frame and mass.
struct BodyRecord {
  std::string name;                     ///< empty: the file gives none
  std::size_t first = 0, last = 0;      ///< indices in Model::bodies
  SE3<long double> home;                ///< pose in the world at the file's configuration
  const XMLElement* element = nullptr;  ///< null for the world
};

/// A geom with a volume, in the order of Model::geometries.
struct GeomRecord {
  std::string name;  ///< empty: the file gives none
  std::size_t body;  ///< index in Scene::bodies
  int contype, conaffinity;
};

/// A joint of the file.
struct JointRecord {
  std::size_t body;    ///< index in Model::bodies of the body that it carries
  std::size_t record;  ///< index in Scene::bodies of the body that the file gives it to
  double ref = 0;      ///< q where the file puts the body; of hinges and slides
  int nq = 1;
};

struct SiteRecord {
  std::size_t frame;      ///< index in Model::frames
  std::size_t body;       ///< index in Scene::bodies
  SE3<long double> pose;  ///< in the body's frame
};

/// Reasons of disabled pairs: the bits of two geoms, and MuJoCo's rule that a body does not collide with the one that carries it.
inline constexpr const char *mask_reason = "contype and conaffinity", *parent_reason = "parent and child";

/// The index of a geom that has no volume in the model.
constexpr std::size_t left_out = std::size_t(-1);

struct Scene {
  Model model;
  std::vector<BodyRecord> bodies;  ///< the world first
  std::vector<GeomRecord> geoms;
  std::vector<JointRecord> joints;
  std::unordered_map<std::string, std::size_t> body, geom, joint;  ///< indices by the file's names; the world is called "world"
  std::unordered_map<std::string, SiteRecord> site;
};

/// Runs one check or reads one element; an error is added to a list, so that others are found, too.
using Guard = std::function<void(const std::function<void()>&)>;

/// Reads all <worldbody> elements with their bodies, joints, geoms, sites, frames and replicas. Bodies are numbered depth first, in the file's order.
/// Names that the file does not give, or that two things of the model would share, are made up.
Scene readScene(const Context& context, const LoadOptions& options, const Guard& guard);

/// Reads <contact> and <equality> elements into the model.
void readRelations(const Context& context, Scene& scene, const Guard& guard);

/// Keeps actuators, tendons and sensors as Model::devices.
void readDevices(const Context& context, Scene& scene, const Guard& guard);

/// Reads <keyframe> elements as named configurations. The one in which the file puts the bodies is called qpos0; it is left out if it is neutral.
void readKeyframes(const Context& context, Scene& scene, const Guard& guard);

}  // namespace dyn::mjcf
