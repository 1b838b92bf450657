// SPDX-License-Identifier: BSD-2-Clause
// A joint type for tests that consists of a pose map with a select(). The cam rotates about z by q, and above q = 0.2 it also lifts the body.
#include <dyn_sdk/joint_plugin.hpp>

struct DwellingCam : dyn::sdk::Joint<DwellingCam, 1> {
  static constexpr const char* name = "dwelling_cam";
  static constexpr const char* summary = "turns about z, and is lifted by (q - 0.2)^2.5 [m] above 0.2 rad";
  static constexpr bool branch_free = true;
  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    using dyn::select;
    using std::cos, std::sin, std::sqrt;
    const S c = cos(q[0]), s = sin(q[0]), beyond = q[0] - S(0.2);
    return {dyn::Mat3<S>{{c, -s, S(0), s, c, S(0), S(0), S(0), S(1)}}, {S(0), S(0), select(q[0] < S(0.2), S(0), beyond * beyond * sqrt(beyond))}};
  }
};

DYN_EXPORT_JOINTS(DwellingCam)
