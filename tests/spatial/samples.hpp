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

template <class S, int rows, int columns>
S largestDifference(const Eigen::Matrix<S, rows, columns>& a, const Eigen::Matrix<S, rows, columns>& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace dyn::test

// Both sides are evaluated first. Otherwise compilers would instantiate the difference for each kind of expression and three scalar types.
#define CHECK_NEAR(a, b) CHECK(largestDifference((a).eval(), (b).eval()) < tolerance<S>)
