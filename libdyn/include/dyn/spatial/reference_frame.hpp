// Where motions of frames are expressed.
#pragma once

namespace dyn {

/// Where a frame's velocity or Jacobian is expressed:
///   LOCAL                the frame's own axes, at its origin
///   WORLD                world axes, the velocity of the body's point at the world's origin
///   LOCAL_WORLD_ALIGNED  world axes, at the frame's origin
enum class ReferenceFrame { LOCAL, WORLD, LOCAL_WORLD_ALIGNED };

}  // namespace dyn
