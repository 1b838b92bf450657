// SPDX-License-Identifier: BSD-2-Clause
// Conversions between spatial quantities and Eigen's matrices. They are inline, so that both sides of a conversion are compiled with the user's
// flags: no Eigen type crosses the library's boundary.
#pragma once

#include <dyn/spatial/inertia.hpp>

#include <Eigen/Core>

namespace dyn {

/// Eigen's vector of six numbers.
template <class S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
/// Eigen's 6 x 6 matrix.
template <class S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;

/// Returns the same numbers as Eigen's vector of 3 or 3 x 3 matrix.
/// @{
template <class S>
Eigen::Matrix<S, 3, 1> toEigen(const Vec3<S>& x) {
  return {x.x, x.y, x.z};
}
template <class S>
Eigen::Matrix<S, 3, 3> toEigen(const Mat3<S>& A) {
  return Eigen::Map<const Eigen::Matrix<S, 3, 3, Eigen::RowMajor>, Eigen::Unaligned>(A.m);
}
template <class S>
Eigen::Matrix<S, 3, 3> toEigen(const Sym3<S>& A) {
  return toEigen(A.matrix());
}
/// @}
/// Returns the six numbers, the linear part first.
/// @{
template <class S>
Vector6<S> toEigen(const Motion<S>& m) {
  return {m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z};
}
template <class S>
Vector6<S> toEigen(const Force<S>& f) {
  return {f.linear.x, f.linear.y, f.linear.z, f.angular.x, f.angular.y, f.angular.z};
}
/// @}
/// Returns the homogeneous 4 x 4 matrix [[R, p], [0, 1]].
template <class S>
Eigen::Matrix<S, 4, 4> toEigen(const SE3<S>& X) {
  Eigen::Matrix<S, 4, 4> H = Eigen::Matrix<S, 4, 4>::Identity();
  H.template topLeftCorner<3, 3>() = toEigen(X.R);
  H.template topRightCorner<3, 1>() = toEigen(X.p);
  return H;
}
/// Returns the 6 x 6 matrix that maps a motion to a momentum, both with the linear part first.
template <class S>
Matrix6<S> toEigen(const Inertia<S>& Y) {
  const Eigen::Matrix<S, 3, 3> mc = toEigen(skew(Y.mass * Y.com));
  Matrix6<S> M;
  M << Y.mass * Eigen::Matrix<S, 3, 3>::Identity(), -mc, mc, toEigen(Y.rotationalAtOrigin());
  return M;
}

/// Returns the same numbers as a Vec3. Compiles only for vectors of fixed size 3.
template <class Derived>
auto fromEigen3(const Eigen::MatrixBase<Derived>& x) {
  EIGEN_STATIC_ASSERT_VECTOR_SPECIFIC_SIZE(Derived, 3);
  return Vec3<typename Derived::Scalar>{x[0], x[1], x[2]};
}
/// Returns the same numbers as a Mat3. Compiles only for matrices of fixed size 3 x 3. R must be a rotation; this is not checked.
template <class Derived>
auto rotationFromEigen(const Eigen::MatrixBase<Derived>& R) {
  EIGEN_STATIC_ASSERT_MATRIX_SPECIFIC_SIZE(Derived, 3, 3);
  Mat3<typename Derived::Scalar> out;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) out(r, c) = R(r, c);
  return out;
}

/// Returns the 6 x 6 Plucker transform X of motions by aMb: X v = aMb.act(v), with the linear part first.
template <class S>
Matrix6<S> actionMatrix6(const SE3<S>& aMb) {
  const Eigen::Matrix<S, 3, 3> R = toEigen(aMb.R);
  Matrix6<S> X = Matrix6<S>::Zero();
  X.template topLeftCorner<3, 3>() = X.template bottomRightCorner<3, 3>() = R;
  X.template topRightCorner<3, 3>() = toEigen(skew(aMb.p)) * R;
  return X;
}

}  // namespace dyn
