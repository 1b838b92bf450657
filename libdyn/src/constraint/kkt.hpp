// SPDX-License-Identifier: BSD-2-Clause
// Constraints by way of M, for any model: J, M^-1 J^T, and the Delassus matrix as their product.
#pragma once

#include "constraint/constraint_data.hpp"

#include <dyn/data/data.hpp>

namespace dyn {

/// Computes M and its factors, J, X = M^-1 J^T, and the Delassus matrix with its bounds. Locates the rows and writes to c.gamma the effect of
/// velocities on their accelerations, without the rows' own bias. v: null at rest.
void projectInertia(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c);

/// x = M^-1 x by the factors of projectInertia.
void solveInertia(const CompactModel& model, Data& data, double* x);

/// out += J x, and x += X lambda.
void addRowsOf(const CompactImpl& m, const ConstraintDataImpl& c, const double* x, double* out);
void addMotionOf(const CompactImpl& m, const ConstraintDataImpl& c, const double* lambda, double* x);

}  // namespace dyn
