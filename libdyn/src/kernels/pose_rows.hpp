// Poses row by row: R beside p, a row in a register of four.
//
// Rows of a product are sums of the second factor's rows, times numbers of the first that memory gives to all lanes at once; and they lie in
// memory as poses do, so that next to nothing is moved from lane to lane.
#pragma once

#include "kernels/lanes.hpp"

#include <dyn/spatial/se3.hpp>

namespace dyn::kernels {

struct PoseRows {
  Four row[3];

  static PoseRows load(const SE3<double>& X) {
    // p's numbers stand last in the four that end with them: nothing is moved from lane to lane.
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = __builtin_shufflevector(*at<Four>(X.R.m + 3 * i), *at<Four>(X.R.m + 6 + i), 0, 1, 2, 7);
    return out;
  }
  /// Of numbers that are at hand: what was just written one by one had better not be read as rows.
  static PoseRows of(const Mat3<double>& R, const Vec3<double>& p) {
    return {{Four{R(0, 0), R(0, 1), R(0, 2), p.x}, Four{R(1, 0), R(1, 1), R(1, 2), p.y}, Four{R(2, 0), R(2, 1), R(2, 2), p.z}}};
  }
  PoseRows moved(const Vec3<double>& by) const {
    return {{row[0] + Four{0, 0, 0, by.x}, row[1] + Four{0, 0, 0, by.y}, row[2] + Four{0, 0, 0, by.z}}};
  }
  /// With R Rz(c, s) for R.
  PoseRows turnZ(double c, double s) const {
    const Four along{c, c, 1, 1}, both = Four{s, s, s, s} * Four{1, -1, 1, 1}, across = __builtin_shufflevector(both, Four{}, 0, 1, 6, 7);
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = row[i] * along + __builtin_shufflevector(row[i], row[i], 1, 0, 2, 3) * across;
    return out;
  }
  /// Turned from outside; store(origin) adds where that happens.
  friend PoseRows operator*(const Mat3<double>& R, const PoseRows& Y) {
    PoseRows out;
    for (int i = 0; i < 3; ++i) out.row[i] = R(i, 0) * Y.row[0] + R(i, 1) * Y.row[1] + R(i, 2) * Y.row[2];
    return out;
  }
  /// Each row goes over what the last one left behind it.
  void store(SE3<double>& X) const {
    for (int i = 0; i < 2; ++i) *at<Four>(X.R.m + 3 * i) = row[i];
    *at<Four>(X.R.m + 6) = __builtin_shufflevector(row[2], row[0], 0, 1, 2, 7);
    *at<Two>(&X.p.y) = Two{row[1][3], row[2][3]};
  }
  /// The same from `origin`.
  void store(const Vec3<double>& origin, SE3<double>& X) const {
    for (int i = 0; i < 3; ++i) *at<Four>(X.R.m + 3 * i) = row[i];
    const Four last = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
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
