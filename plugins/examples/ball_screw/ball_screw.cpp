// SPDX-License-Identifier: BSD-2-Clause
// A screw whose pitch changes along its travel: turning by q about z moves it by p q + c q^2.
#include <dyn_sdk/joint_plugin.hpp>

struct BallScrew : dyn::sdk::Joint<BallScrew, 1> {
  static constexpr const char* name = "ball_screw";
  static constexpr const char* summary = "rotation about z by q [rad] with translation p q + c q^2 along it";
  static constexpr bool branch_free = true;
  static constexpr std::array parameters{dyn::ParameterSpec{"p", dyn::ParameterKind::number, true, "m/rad", "pitch at q = 0"},
                                         dyn::ParameterSpec{"c", dyn::ParameterKind::number, true, "m/rad^2", "half the change of pitch"}};

  template <class S>
  static dyn::SE3<S> pose(const S* q, const auto& c) {
    using std::cos, std::sin;
    const S a = cos(q[0]), b = sin(q[0]);
    return {{{a, -b, S(0), b, a, S(0), S(0), S(0), S(1)}}, {S(0), S(0), (S(c[0]) + S(c[1]) * q[0]) * q[0]}};
  }
};

DYN_EXPORT_JOINTS(BallScrew)
