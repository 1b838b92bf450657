// SPDX-License-Identifier: BSD-2-Clause
// The axes and origin in which motions of frames are expressed.
#pragma once

namespace dyn {

/// The axes and the point in which a frame's velocity, acceleration or Jacobian is expressed.
enum class ReferenceFrame {
  LOCAL,               ///< the frame's axes, at the frame's origin
  WORLD,               ///< world axes, at the body's point that coincides with the world's origin
  LOCAL_WORLD_ALIGNED  ///< world axes, at the frame's origin
};

}  // namespace dyn
