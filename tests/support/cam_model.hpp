// SPDX-License-Identifier: BSD-2-Clause
// A model whose mass matrix is singular at q = 0, because its joint, "cam", does not move there.
#pragma once

#include <dyn/model/model.hpp>

namespace dyn::test {

inline Model camModel() {
  Model model;
  JointDescription joint;
  joint.name = "cam";
  joint.type = "cam_follower";
  joint.parameters["h"] = std::vector<double>{0.1};
  model.addBody("follower", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  return model;
}

}  // namespace dyn::test
