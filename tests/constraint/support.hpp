// SPDX-License-Identifier: BSD-2-Clause
// References for constraints: rows from the velocities and accelerations of frames, and dense equations in extended precision.
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

/// Rows of constraints between frames. The placements of the constraints must be the identity.
DenseRows denseRows(const CompactModel& model, Data& data, const std::vector<ConstraintDescription>& set, const Eigen::VectorXd& q,
                    const Eigen::VectorXd& v);

/// Solution of M x = f + J^T lambda, J x = b in long double. If b cannot be met, |J x - b| is least. If lambda is not unique, its norm is least.
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

/// models/biped.urdf on a floating base.
CompactModel biped();
/// The constraint under another name, of which a set has only one each.
ConstraintDescription renamed(ConstraintDescription c, const std::string& name);

/// A random tree with random constraints between its bodies and the world, and a random state.
Subject randomScene(std::uint64_t seed, int bodies, int constraints);

}  // namespace dyn::test
