// SPDX-License-Identifier: BSD-2-Clause
// Random spatial quantities of any scalar type, and the difference of matrices.
#pragma once

#include "support/catch.hpp"
#include "support/random_model.hpp"

#include <dyn/spatial/eigen.hpp>

#include <Eigen/LU>

#include <limits>

namespace dyn::test {

template <class S>
struct Sample {
  explicit Sample(std::uint64_t seed) : random(seed) {}
  Random random;
  Vec3<S> vector() {
    const Vec3<double> x = random.vector();
    return {static_cast<S>(x.x), static_cast<S>(x.y), static_cast<S>(x.z)};
  }
  SE3<S> pose() { return {exp3(vector()), vector()}; }
  Motion<S> motion() { return {vector(), vector()}; }
  Force<S> force() { return {vector(), vector()}; }
  Inertia<S> inertia() { return cast<S>(random.inertia()); }
};

template <class S>
constexpr S tolerance = S(40) * std::numeric_limits<S>::epsilon();

/// References are computed in long doubles and matrices of any size. So Eigen's products and inverses are compiled once, and not for each scalar type
/// and each pair of shapes.
using Dense = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

template <class S, int rows, int columns>
Dense dense(const Eigen::Matrix<S, rows, columns>& x) {
  Dense result(rows, columns);
  for (int j = 0; j < columns; ++j)
    for (int i = 0; i < rows; ++i) result(i, j) = static_cast<long double>(x(i, j));
  return result;
}

/// Any spatial quantity that has an Eigen form.
template <class X>
Dense dense(const X& x) {
  return dense(toEigen(x));
}

inline Dense homogeneous(const Dense& x) {
  Dense result = Dense::Ones(4, 1);
  result.topRows(3) = x;
  return result;
}

inline long double largestDifference(const Dense& a, const Dense& b) { return (a - b).cwiseAbs().maxCoeff(); }

}  // namespace dyn::test

#define CHECK_NEAR(a, b) CHECK(largestDifference(a, b) < static_cast<long double>(tolerance<S>))
