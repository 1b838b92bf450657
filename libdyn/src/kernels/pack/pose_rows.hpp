// SPDX-License-Identifier: BSD-2-Clause
// Poses as three rows of (R, p), each row in a register of four.
//
// A row of a product is a sum of the second factor's rows times numbers of the first factor, which a load copies to all lanes. Rows lie in memory
// as poses do, so almost nothing moves between lanes.
#pragma once

#include "kernels/pack/lanes.hpp"

#include <dyn/spatial/se3.hpp>

namespace dyn::kernels {

struct PoseRows {
  Vec4d row[3];

  static PoseRows load(const SE3<double>& X) {
    // The four numbers that end with p[i] have it in their last lane, so nothing moves between lanes.
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = __builtin_shufflevector(*at<Vec4d>(X.R.m + 3 * i), *at<Vec4d>(X.R.m + 6 + i), 0, 1, 2, 7);
    return out;
  }
  /// Makes rows of numbers in registers. Reading a row of numbers that were just written one by one would stall the core.
  static PoseRows of(const Mat3<double>& R, const Vec3<double>& p) {
    return {{Vec4d{R(0, 0), R(0, 1), R(0, 2), p.x}, Vec4d{R(1, 0), R(1, 1), R(1, 2), p.y}, Vec4d{R(2, 0), R(2, 1), R(2, 2), p.z}}};
  }
  PoseRows moved(const Vec3<double>& by) const {
    return {{row[0] + Vec4d{0, 0, 0, by.x}, row[1] + Vec4d{0, 0, 0, by.y}, row[2] + Vec4d{0, 0, 0, by.z}}};
  }
  /// The pose with R Rz(c, s) in place of R.
  PoseRows turnZ(double c, double s) const {
    const Vec4d along{c, c, 1, 1}, both = Vec4d{s, s, s, s} * Vec4d{1, -1, 1, 1}, across = __builtin_shufflevector(both, Vec4d{}, 0, 1, 6, 7);
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = row[i] * along + __builtin_shufflevector(row[i], row[i], 1, 0, 2, 3) * across;
    return out;
  }
  /// Y with its rotation and translation turned by R. store(origin, X) adds the origin of R's frame.
  friend PoseRows operator*(const Mat3<double>& R, const PoseRows& Y) {
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = R(i, 0) * Y.row[0] + R(i, 1) * Y.row[1] + R(i, 2) * Y.row[2];
    return out;
  }
  /// Each row overwrites the surplus fourth number of the row before.
  void store(SE3<double>& X) const {
    for (int i = 0; i < 2; ++i) *at<Vec4d>(X.R.m + 3 * i) = row[i];
    *at<Vec4d>(X.R.m + 6) = __builtin_shufflevector(row[2], row[0], 0, 1, 2, 7);
    *at<Two>(&X.p.y) = Two{row[1][3], row[2][3]};
  }
  /// The same with `origin` added to the translation.
  void store(const Vec3<double>& origin, SE3<double>& X) const {
    for (int i = 0; i < 3; ++i) *at<Vec4d>(X.R.m + 3 * i) = row[i];
    const Vec4d last = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
    *at<Two>(&X.p.x) = __builtin_shufflevector(last, last, 2, 3) + *at<Two>(&origin.x);
    X.p.z = row[2][3] + origin.z;
  }

 private:
  typedef double Two __attribute__((vector_size(16)));
  template <class Vector>
  struct Anywhere {
    typedef Vector type __attribute__((aligned(8)));
  };
  template <class Vector>
  static const typename Anywhere<Vector>::type* at(const double* x) {
    return reinterpret_cast<const typename Anywhere<Vector>::type*>(x);
  }
  template <class Vector>
  static typename Anywhere<Vector>::type* at(double* x) {
    return reinterpret_cast<typename Anywhere<Vector>::type*>(x);
  }
};

}  // namespace dyn::kernels
