// SPDX-License-Identifier: BSD-2-Clause
// A carriage on an elliptic track in the xy plane. Its coordinate q is the angle of the ellipse's parameter form, p = (a cos q, b sin q). The
// carriage's x axis points along the track. The SDK derives velocities, accelerations and all derivatives from the pose.
#include <dyn_sdk/joint_plugin.hpp>

struct EllipticTrack : dyn::sdk::Joint<EllipticTrack, 1> {
  static constexpr const char* name = "elliptic_track";
  static constexpr const char* summary = "carriage on the ellipse (a cos q, b sin q) in the xy plane, x along the track";
  static constexpr bool branch_free = true;  // no `if` on q below, so it may be computed for several q at once
  static constexpr std::array parameters{dyn::ParameterSpec{"a", dyn::ParameterKind::number, true, "m", "half axis along x"},
                                         dyn::ParameterSpec{"b", dyn::ParameterKind::number, true, "m", "half axis along y"}};

  /// Refuses parameters without which the tangent could vanish.
  static bool check(const dyn::ParameterArgument* args, dyn::JointInstance&, const dyn::sdk::Refusal& refuse) {
    return (args[0].numbers[0] > 0 && args[1].numbers[0] > 0) || refuse("a and b must be positive");
  }

  template <class S>
  static dyn::SE3<S> pose(const S* q, const auto& c) {
    using std::cos, std::sin, std::sqrt;
    const S a = S(c[0]), b = S(c[1]), co = cos(q[0]), si = sin(q[0]);
    const S x = -(a * si), y = b * co, length = sqrt(x * x + y * y);  // the tangent
    const S tx = x / length, ty = y / length;
    return {{{tx, -ty, S(0), ty, tx, S(0), S(0), S(0), S(1)}}, {a * co, b * si, S(0)}};
  }
};

DYN_EXPORT_JOINTS(EllipticTrack)
