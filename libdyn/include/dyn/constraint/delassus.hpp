// SPDX-License-Identifier: BSD-2-Clause
// The Delassus matrix J M^-1 J^T, which maps forces of the rows to the accelerations that they cause in the rows.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

namespace detail {
DYN_API const double* delassusMatrix(const CompactModel&, Data&, VectorView q, ConstraintData&);
DYN_API const double* operationalSpaceInertia(const CompactModel&, Data&, VectorView q, ConstraintData&);
DYN_API void prepareDelassus(const CompactModel&, Data&, VectorView q, ConstraintData&);
DYN_API void applyDelassus(const CompactModel&, Data&, ConstraintData&, VectorView x, const VectorOut& out);
}  // namespace detail

/// Computes the Delassus matrix, rows x rows [1/kg, 1/(kg m^2)], symmetric and positive semidefinite.
/// O(n + d rows^2) for d degrees of freedom between constraints and the world. Featherstone 2010. A model with dependent joints factors M instead,
/// O(n^3), and needs Need::mass_matrix. Throws Error(size | argument | singular).
inline MatrixResult computeDelassusMatrix(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  const int rows = constraints.set().rows();
  return {detail::delassusMatrix(model, data, q, constraints), rows, rows};
}

/// Computes the inverse of the Delassus matrix, rows x rows: the inertia that is felt at the constraints' frames (Khatib 1987). With redundant rows
/// it is the pseudo-inverse; ConstraintSettings decide the rank. O(n + rows^3). Throws as computeDelassusMatrix.
inline MatrixResult computeOperationalSpaceInertia(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  const int rows = constraints.set().rows();
  return {detail::operationalSpaceInertia(model, data, q, constraints), rows, rows};
}

/// The Delassus matrix at one q as an operator, without forming it: O(n) a product, or O(n^2 + n rows) for a model with dependent joints. The
/// operator keeps references to its arguments. No other algorithm may use this Data or ConstraintData between construction and the last product.
class DelassusOperator {
 public:
  /// Prepares the products at q. O(n). A model with dependent joints factors M, O(n^3). Throws as computeDelassusMatrix.
  DelassusOperator(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints)
      : model_(model), data_(data), constraints_(constraints) {
    detail::prepareDelassus(model, data, q, constraints);
  }
  /// Writes out = J M^-1 J^T x. Both vectors have `rows` numbers, and they may be the same. Throws Error(size).
  void apply(const VectorArg& x, const VectorOut& out) const { detail::applyDelassus(model_, data_, constraints_, x, out); }

 private:
  const CompactModel& model_;
  Data& data_;
  ConstraintData& constraints_;
};

}  // namespace dyn
