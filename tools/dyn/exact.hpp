// SPDX-License-Identifier: BSD-2-Clause
// Fifty-digit vectors and rotations, and poses as power series of time.
#pragma once

#include "exact_matrix.hpp"

#include <dyn/spatial/vector3.hpp>

#include <Eigen/Core>

#include <array>
#include <vector>

namespace dyn::tool {

using Real = ExactNumber<50>;
using MatrixR = ExactMatrix<50>;
using VectorR = MatrixR;  ///< of one column
using Vec = MatrixR;      ///< 3 x 1
using Mat = MatrixR;      ///< 3 x 3

Vec vec(const Vec3<double>& x);
VectorR exact(const Eigen::VectorXd& x);
inline Mat cross(const Vec& w) { return Mat::cross(w); }
/// The w for which W = cross(w).
Vec uncross(const Mat& W);
double length(const Vec& x);

/// A pose as a power series in t: its value and its first and second derivatives.
struct Series {
  std::array<Mat, 3> R;
  std::array<Vec, 3> p;

  static Series constant(const Mat& R, const Vec& p);
  static Series identity();
  Series operator*(const Series& b) const;
  Vec omega() const;
  Vec alpha() const;
};

}  // namespace dyn::tool
