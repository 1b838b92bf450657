// SPDX-License-Identifier: BSD-2-Clause
#include "exact.hpp"

namespace dyn::tool {

Vec vec(const Vec3<double>& x) { return {Real(x.x), Real(x.y), Real(x.z)}; }

VectorR exact(const Eigen::VectorXd& x) {
  VectorR out(x.size());
  for (Eigen::Index k = 0; k < x.size(); ++k) out[k] = Real(x[k]);
  return out;
}

Vec uncross(const Mat& W) { return Vec(W(2, 1) - W(1, 2), W(0, 2) - W(2, 0), W(1, 0) - W(0, 1)) / Real(2); }

double length(const Vec& x) { return static_cast<double>(x.norm()); }

Series Series::constant(const Mat& R, const Vec& p) { return {{R, Mat::Zero(3, 3), Mat::Zero(3, 3)}, {p, Vec::Zero(3), Vec::Zero(3)}}; }
Series Series::identity() { return constant(Mat::Identity(3), Vec::Zero(3)); }

Series Series::operator*(const Series& b) const {
  Series out;
  out.R[0] = R[0] * b.R[0];
  out.R[1] = R[1] * b.R[0] + R[0] * b.R[1];
  out.R[2] = R[2] * b.R[0] + Real(2) * (R[1] * b.R[1]) + R[0] * b.R[2];
  out.p[0] = p[0] + R[0] * b.p[0];
  out.p[1] = p[1] + R[1] * b.p[0] + R[0] * b.p[1];
  out.p[2] = p[2] + R[2] * b.p[0] + Real(2) * (R[1] * b.p[1]) + R[0] * b.p[2];
  return out;
}

Vec Series::omega() const { return uncross(R[1] * R[0].transpose()); }
Vec Series::alpha() const { return uncross(R[2] * R[0].transpose() + R[1] * R[1].transpose()); }

}  // namespace dyn::tool
