// SPDX-License-Identifier: BSD-2-Clause
// States of a model, one a column, for tests of batches.
#pragma once

#include "support/random_model.hpp"

#include <dyn/dyn.hpp>

namespace dyn::test {

/// Configurations away from neutral, velocities and accelerations.
struct States {
  States(const CompactModel& model, int n, std::uint64_t seed) : q(model.nq(), n), v(model.nv(), n), a(model.nv(), n) {
    Random random(seed);
    for (int k = 0; k < n; ++k) {
      q.col(k) = integrate(model, neutral(model), Eigen::VectorXd(random.vector(model.nv(), 0.4).array() + 0.8));
      v.col(k) = random.vector(model.nv(), 1);
      a.col(k) = random.vector(model.nv(), 1);
    }
  }
  Eigen::MatrixXd q, v, a;
};

}  // namespace dyn::test
