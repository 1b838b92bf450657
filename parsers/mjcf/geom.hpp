// SPDX-License-Identifier: BSD-2-Clause
// Geoms: their volumes and their mass.
#pragma once

#include "mesh.hpp"
#include "xml/notes.hpp"

namespace dyn::mjcf {

/// Everything about a model that its elements are read with.
struct Context {
  const Source& source;
  const Settings& settings;
  const Defaults& defaults;
  Meshes& meshes;
  xml::Notes& notes;
};

struct Geom {
  SE3<long double> pose;         ///< in the body's frame
  Inertia<long double> inertia;  ///< in the body's frame; zero unless it was asked for
  std::optional<GeometryShape> shape;
  SE3<long double> shape_pose;       ///< in the body's frame
  int contype = 1, conaffinity = 1;  ///< two geoms collide if a bit of one's contype is in the other's conaffinity
  bool visual() const { return contype == 0 && conaffinity == 0; }
};

/// Reads a geom; `frame` is the pose of its surroundings in the body's frame. Throws Error(syntax | model) for sizes, types and masses that MuJoCo
/// does not have. A shape that libdyn does not have is left out, with a note. `weigh` says whether its mass is needed.
Geom readGeom(const Values& values, const SE3<long double>& frame, bool weigh, const Context& context);

/// Returns the centre and rotation of a geom or site between the two points of `fromto`, and writes half their distance.
SE3<long double> poseBetween(const Values& values, long double& half_length);

}  // namespace dyn::mjcf
