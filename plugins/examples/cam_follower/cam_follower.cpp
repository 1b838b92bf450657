// SPDX-License-Identifier: BSD-2-Clause
// A follower on an eccentric cam: it moves along z by h (1 - cos q) as the cam turns by q. At q = 0 and pi it stands still, so the
// motion subspace vanishes there.
#include <dyn_sdk/joint_plugin.hpp>

struct CamFollower : dyn::sdk::Joint<CamFollower, 1> {
  static constexpr const char* name = "cam_follower";
  static constexpr const char* summary = "translation along z by h (1 - cos q), q the cam's angle [rad]";
  static constexpr bool branch_free = true;  // no `if` on q below, so it may be computed for several q at once
  static constexpr std::array parameters{dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", "half the stroke"}};

  template <class S>
  static dyn::SE3<S> pose(const S* q, const auto& c) {
    using std::sin;
    const S half = sin(S(0.5) * q[0]);
    return {dyn::Mat3<S>::identity(), {S(0), S(0), S(2 * c[0]) * half * half}};  // 1 - cos q without cancellation
  }
};

DYN_EXPORT_JOINTS(CamFollower)
