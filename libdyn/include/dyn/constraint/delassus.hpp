// The Delassus matrix J M^-1 J^T: what accelerations of the rows forces of the rows make.
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

/// rows x rows, [1/kg, 1/(kg m^2)]: symmetric, positive semidefinite. O(n + dofs between constraints and the world x rows^2). Featherstone 2010.
/// Throws Error(size | argument | singular).
inline MatrixResult computeDelassusMatrix(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  const int rows = constraints.set().rows();
  return {detail::delassusMatrix(model, data, q, constraints), rows, rows};
}

/// Its inverse, the inertia that is felt at the constraints' frames (Khatib 1987); where rows imply each other, the pseudo-inverse. Rank as
/// ConstraintSettings say. O(n + rows^3).
inline MatrixResult computeOperationalSpaceInertia(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  const int rows = constraints.set().rows();
  return {detail::operationalSpaceInertia(model, data, q, constraints), rows, rows};
}

/// The same matrix as an operator, at one q, without forming it: O(n) a product.
/// No other algorithm may use this Data or ConstraintData between construction and the last product.
class DelassusOperator {
 public:
  /// O(n). Throws as computeDelassusMatrix.
  DelassusOperator(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints)
      : model_(model), data_(data), constraints_(constraints) {
    detail::prepareDelassus(model, data, q, constraints);
  }
  /// out = J M^-1 J^T x; both of `rows` numbers, and they may be the same.
  void apply(const VectorArg& x, const VectorOut& out) const { detail::applyDelassus(model_, data_, constraints_, x, out); }

 private:
  const CompactModel& model_;
  Data& data_;
  ConstraintData& constraints_;
};

}  // namespace dyn
