// SPDX-License-Identifier: BSD-2-Clause
// Takes robots that urdfdom has parsed, as programs of ROS hold them. This header and the library libdyn_urdfdom (CMake: libdyn::urdfdom, component
// `urdfdom`) are there if urdfdom was when libdyn was built.
#pragma once

#include <dyn/parsers/urdf.hpp>

#include <urdf_model/model.h>

namespace dyn::urdf {

/// Returns the Model that load() makes of the same file, up to the last digit of rotations, which urdfdom keeps as quaternions. It has no lines of
/// the file in messages, and nothing that urdfdom does not read: libdyn's extension, `<collision_checking>`, cones, half-spaces, octrees; and
/// capsules and limits of acceleration only as far as that version of urdfdom has them. Siblings are in the order of their names, whatever
/// options.order says. Throws Error(model | syntax) as load().
DYN_API Model fromUrdfdom(const ::urdf::ModelInterface& robot, const Options& options = {});

}  // namespace dyn::urdf
