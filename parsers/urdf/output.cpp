// SPDX-License-Identifier: BSD-2-Clause
#include "output.hpp"

#include <cmath>

namespace dyn::urdf {

namespace {

/// Roll, pitch and yaw with R = Rz(yaw) Ry(pitch) Rx(roll). Where roll and yaw are about one axis, roll is what yaw leaves, so no digits are lost.
Vec3<double> anglesOf(const Mat3<double>& matrix) {
  const Mat3<long double> R = cast<long double>(matrix);
  const long double yaw = std::atan2(R(1, 0), R(0, 0)), c = std::cos(yaw), s = std::sin(yaw);
  const long double pitch = std::atan2(-R(2, 0), c * R(0, 0) + s * R(1, 0));
  const long double roll = std::atan2(s * R(0, 2) - c * R(1, 2), c * R(1, 1) - s * R(0, 1));
  return {static_cast<double>(roll), static_cast<double>(pitch), static_cast<double>(yaw)};
}

bool isZero(const Vec3<double>& x) { return x.x == 0 && x.y == 0 && x.z == 0; }

}  // namespace

void Output::putPose(const SE3<double>& X, const char* xyz, const char* rpy) {
  if (!isZero(X.p)) put(xyz, X.p);
  if (const Vec3<double> angles = anglesOf(X.R); !isZero(angles)) put(rpy, angles);
}

void Output::origin(const SE3<double>& X) {
  if (isZero(X.p) && isZero(anglesOf(X.R))) return;
  open("origin");
  putPose(X);
  close();
}

}  // namespace dyn::urdf
