// Constraints written out from frames' own velocities and accelerations, and dense equations in extended precision.
#pragma once

#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <Eigen/Core>

namespace dyn::test {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

struct DenseRows {
  Eigen::MatrixXd J;
  Eigen::VectorXd velocity, gamma;
};

/// Rows of constraints between frames (their placements must be the identity).
DenseRows denseRows(const CompactModel& model, Data& data, const std::vector<ConstraintDescription>& set, const Eigen::VectorXd& q,
                    const Eigen::VectorXd& v);

/// M x = f + J^T lambda, J x = b: least norm of lambda, least squares of J x - b in the metric of M^-1's range.
struct DenseSolution {
  LongVector x, lambda;
};
DenseSolution solveKkt(const Eigen::MatrixXd& M, const Eigen::MatrixXd& J, const LongVector& f, const LongVector& b);

double relativeTo(const Eigen::VectorXd& x, const LongVector& reference);

struct Subject {
  CompactModel model;
  std::vector<ConstraintDescription> constraints;
  Eigen::VectorXd q, v, tau;
};

/// A random tree, a few constraints of random kinds between random bodies of it and the world.
Subject randomScene(std::uint64_t seed, int bodies, int constraints);

}  // namespace dyn::test
