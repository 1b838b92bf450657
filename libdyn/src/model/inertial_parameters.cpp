// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/error.hpp>
#include <dyn/spatial/eigen.hpp>
#include <dyn/spatial/inertial_parameters.hpp>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn {

DynamicParameters toDynamicParameters(const Inertia<double>& Y) {
  const Vec3<double> h = Y.mass * Y.com;
  const Sym3<double> I = Y.rotationalAtOrigin();
  return {Y.mass, h.x, h.y, h.z, I.xx, I.xy, I.yy, I.xz, I.yz, I.zz};
}

Inertia<double> inertiaFromDynamicParameters(const DynamicParameters& pi) {
  const Vec3<double> h{pi[1], pi[2], pi[3]};
  const Sym3<double> I{pi[4], pi[5], pi[7], pi[6], pi[8], pi[9]};
  if (pi[0] == 0) {
    if (h.x != 0 || h.y != 0 || h.z != 0)
      throw Error(ErrorCode::argument, "dynamic parameters: the mass is zero and the first moment is not, which no body has");
    return {0, {}, I};
  }
  const Vec3<double> c = (1 / pi[0]) * h;
  return {pi[0], c, I - pi[0] * pointInertia(c)};
}

PseudoInertia pseudoInertia(const DynamicParameters& pi) {
  const double half = 0.5 * (pi[4] + pi[6] + pi[9]);
  return {half - pi[4], -pi[5], -pi[7], pi[1], -pi[5], half - pi[6], -pi[8], pi[2], -pi[7], -pi[8], half - pi[9], pi[3], pi[1], pi[2], pi[3], pi[0]};
}

DynamicParameters dynamicParameters(const PseudoInertia& J) {
  const double trace = J[0] + J[5] + J[10];
  return {J[15], J[3], J[7], J[11], trace - J[0], -J[1], trace - J[5], -J[2], -J[6], trace - J[10]};
}

PseudoInertia pseudoInertiaFromLogCholesky(const LogCholeskyParameters& theta) {
  Eigen::Matrix4d U;
  U << std::exp(theta[1]), theta[4], theta[6], theta[7], 0, std::exp(theta[2]), theta[5], theta[8], 0, 0, std::exp(theta[3]), theta[9], 0, 0, 0, 1;
  U *= std::exp(theta[0]);
  PseudoInertia J;
  Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(J.data()) = U * U.transpose();
  return J;
}

LogCholeskyParameters logCholesky(const PseudoInertia& J) {
  // J = U U^T with U upper triangular: Cholesky from the last row up.
  Eigen::Matrix4d A = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(J.data()), U = Eigen::Matrix4d::Zero();
  for (int k = 3; k >= 0; --k) {
    if (!(A(k, k) > 0) || !std::isfinite(A(k, k)))
      throw Error(ErrorCode::argument, "logCholesky: the pseudo-inertia is not positive definite; no body of positive density has it");
    U(k, k) = std::sqrt(A(k, k));
    for (int i = 0; i < k; ++i) U(i, k) = A(i, k) / U(k, k);
    for (int i = 0; i < k; ++i)
      for (int j = 0; j < k; ++j) A(i, j) -= U(i, k) * U(j, k);
  }
  const double scale = U(3, 3);
  U /= scale;
  return {std::log(scale), std::log(U(0, 0)), std::log(U(1, 1)), std::log(U(2, 2)), U(0, 1), U(1, 2), U(0, 2), U(0, 3), U(1, 3), U(2, 3)};
}

PhysicalConsistency physicalConsistency(const Inertia<double>& Y) {
  const Sym3<double>& I = Y.rotational;
  const double size = std::max({std::fabs(I.xx), std::fabs(I.yy), std::fabs(I.zz), std::fabs(I.xy), std::fabs(I.xz), std::fabs(I.yz)});
  const double first_moment = Y.mass * (std::fabs(Y.com.x) + std::fabs(Y.com.y) + std::fabs(Y.com.z));
  if (!(Y.mass >= 0) || !std::isfinite(first_moment) || !std::isfinite(size)) return {false, -1};
  if (size == 0) return {true, 0};
  if (Y.mass == 0) return {false, -1};
  const Eigen::Vector3d moments = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(toEigen(I), Eigen::EigenvaluesOnly).eigenvalues();
  const Eigen::Array3d second = 0.5 * moments.sum() - moments.array();
  const double margin = second.minCoeff() / second.abs().maxCoeff();
  return {margin >= -16 * std::numeric_limits<double>::epsilon(), margin};
}

}  // namespace dyn
