// SPDX-License-Identifier: BSD-2-Clause
// The difference of two matrices.
#pragma once

#include <Eigen/Core>

#include <algorithm>

namespace dyn::test {

/// Largest difference of two entries, relative to the largest expected entry if that is above 1.
inline double off(const Eigen::MatrixXd& x, const Eigen::MatrixXd& expected) {
  return (x - expected).cwiseAbs().maxCoeff() / std::max(1.0, expected.cwiseAbs().maxCoeff());
}

}  // namespace dyn::test
