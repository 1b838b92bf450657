// SPDX-License-Identifier: BSD-2-Clause
// Names for what a file leaves nameless. MuJoCo asks for none; libdyn's bodies, frames, joints and volumes have one each.
#pragma once

#include "scene.hpp"

namespace dyn::mjcf {

/// Names bodies, joints, volumes and frames. Names of the file stay, except those of frames that a body has, too. Others are made of the body's name:
/// BODY_JOINT for a body that only carries a joint, BODY_joint, BODY_fixed, BODY_0, BODY_visual_0, BODY_site_0; a nameless body is body_3, where 3 is
/// MuJoCo's number of it.
void nameAll(Scene& scene);

}  // namespace dyn::mjcf
