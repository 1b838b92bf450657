// The factors of M that follow the tree: M = U D U^T, U unit upper triangular, with entries for joints on one path to the root only.
//
// decompose() takes the M of the last crba(); the others the factors of the last decompose(). In place on the caller's vectors and matrices
// of nv rows: O(n depth) a column. Need Need::derivatives. They throw Error(size | argument), and Error(argument) for models with joints that
// follow others, whose M has entries between distant joints. Featherstone 2005.
#pragma once

#include <dyn/algorithm/rnea.hpp>

namespace dyn {

namespace detail {
enum class Product { inverse, mass_matrix, upper, transposed };
DYN_API void choleskyDecompose(const CompactModel&, Data&);
DYN_API void choleskyTimes(const CompactModel&, Data&, Product, const MatrixOut& X);
DYN_API double conditionOfMassMatrix(const CompactModel&, Data&);
DYN_API const double* forwardDynamics(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau);
template <class T>
MatrixOut columnsOf(T&& x) {
  if constexpr (int(std::remove_cvref_t<T>::IsVectorAtCompileTime)) {
    return {x.data(), x.size(), 1};
  } else {
    return MatrixOut(x);
  }
}
}  // namespace detail

namespace cholesky {

/// O(n depth^2). Throws Error(singular) naming the joint where M is singular.
inline void decompose(const CompactModel& model, Data& data) { detail::choleskyDecompose(model, data); }

/// X <- M^-1 X.
template <detail::Writable T>
void solve(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::inverse, detail::columnsOf(X));
}
/// X <- M X.
template <detail::Writable T>
void Mv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::mass_matrix, detail::columnsOf(X));
}
/// X <- U X.
template <detail::Writable T>
void Uv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::upper, detail::columnsOf(X));
}
/// X <- U^T X.
template <detail::Writable T>
void Utv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::transposed, detail::columnsOf(X));
}

}  // namespace cholesky

/// Condition of M by the factors of the last decompose(), of a model with joints that follow others by the M of the last crba(): how much of the
/// accuracy of M is lost on the way to M^-1 and to accelerations. With 10^12 four digits of double are left, with 10^16 none. Each row and column is
/// divided by the root of its diagonal entry first, so that units and sizes of bodies do not count. In the 1-norm, estimated from below, within a
/// factor of three as a rule: Hager 1984, Higham 1988. O(n^2).
inline double conditionOfMassMatrix(const CompactModel& model, Data& data) { return detail::conditionOfMassMatrix(model, data); }

/// ddq = M^-1 (tau - C v - g - losses) through crba and the factors of M: what aba gives, at about twice the cost, and with errors that grow
/// with the condition of M instead of staying at a few roundings. Leaves M and its factors for cholesky::solve.
inline VectorResult forwardDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau) {
  return {detail::forwardDynamics(model, data, q, v, tau), model.nv()};
}

}  // namespace dyn
