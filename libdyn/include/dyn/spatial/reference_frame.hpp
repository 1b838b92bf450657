// SPDX-License-Identifier: BSD-2-Clause
// The axes and origin in which motions of frames are expressed.
#pragma once

namespace dyn {

/// A frame's velocity or Jacobian is expressed in
///   LOCAL                the frame's axes, at the frame's origin
///   WORLD                world axes, as the velocity of the body's point at the world's origin
///   LOCAL_WORLD_ALIGNED  world axes, at the frame's origin
enum class ReferenceFrame { LOCAL, WORLD, LOCAL_WORLD_ALIGNED };

}  // namespace dyn
