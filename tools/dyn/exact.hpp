// SPDX-License-Identifier: BSD-2-Clause
// Fifty-digit vectors and rotations, and poses as power series of time.
#pragma once

#include "exact_number.hpp"

#include <dyn/spatial/vector3.hpp>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <vector>

namespace dyn::tool {

using Real = ExactNumber<50>;
using Vec = Eigen::Matrix<Real, 3, 1>;
using Mat = Eigen::Matrix<Real, 3, 3>;
using VectorR = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using MatrixR = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;

inline Vec vec(const Vec3<double>& x) { return {Real(x.x), Real(x.y), Real(x.z)}; }
inline Mat cross(const Vec& w) {
  Mat out;
  out << Real(0), -w.z(), w.y(), w.z(), Real(0), -w.x(), -w.y(), w.x(), Real(0);
  return out;
}
inline Vec uncross(const Mat& W) { return Vec(W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)) / Real(2); }

/// A pose as a power series in t: its value and its first and second derivatives.
struct Series {
  std::array<Mat, 3> R;
  std::array<Vec, 3> p;

  static Series constant(const Mat& R, const Vec& p) { return {{R, Mat::Zero(), Mat::Zero()}, {p, Vec::Zero(), Vec::Zero()}}; }
  friend Series operator*(const Series& a, const Series& b) {
    Series out;
    out.R = {a.R[0] * b.R[0], a.R[1] * b.R[0] + a.R[0] * b.R[1], a.R[2] * b.R[0] + Real(2) * (a.R[1] * b.R[1]) + a.R[0] * b.R[2]};
    out.p = {a.p[0] + a.R[0] * b.p[0], a.p[1] + a.R[1] * b.p[0] + a.R[0] * b.p[1],
             a.p[2] + a.R[2] * b.p[0] + Real(2) * (a.R[1] * b.p[1]) + a.R[0] * b.p[2]};
    return out;
  }
  Vec omega() const { return uncross(R[1] * R[0].transpose()); }
  Vec alpha() const { return uncross(R[2] * R[0].transpose() + R[1] * R[1].transpose()); }
};

inline std::vector<long double> rounded(const MatrixR& x) {
  std::vector<long double> out;
  for (Eigen::Index i = 0; i < x.rows(); ++i)
    for (Eigen::Index j = 0; j < x.cols(); ++j) out.push_back(static_cast<long double>(x(i, j)));
  return out;
}

inline VectorR exact(const Eigen::VectorXd& x) {
  VectorR out(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) out[k] = Real(x[k]);
  return out;
}

inline double length(const Vec& x) { return static_cast<double>(x.norm()); }

}  // namespace dyn::tool
