// SPDX-License-Identifier: BSD-2-Clause
// The pose map of this type throws, which is not allowed.
#include <dyn_sdk/joint_plugin.hpp>

#include <stdexcept>

struct ThrowsInPose : dyn::sdk::Joint<ThrowsInPose, 1> {
  static constexpr const char* name = "throws_in_pose";
  static constexpr const char* summary = "for tests";
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    if (dyn::valueOf(q[0]) > 0.1) throw std::out_of_range("the table ends at 0.1");
    return {dyn::Mat3<S>::identity(), {q[0], S(0), S(0)}};
  }
};

DYN_EXPORT_JOINTS(ThrowsInPose)
