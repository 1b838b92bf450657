// SPDX-License-Identifier: BSD-2-Clause
// Tree-sparse factors of M, its condition, and forward dynamics through the factors.
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

/// Tree-sparse factors of M = U D U^T (Featherstone 2005). U is unit upper triangular and has entries only between joints on one root path.
///
/// decompose() reads the M of the last crba(). The other functions read the factors of the last decompose() and overwrite X, the caller's vector of
/// nv numbers or matrix of nv rows, with their result; O(n depth) a column. Columns of a matrix are computed side by side, in as many lanes as a
/// register has, which takes a third of the time that the same columns take one by one. All need Need::derivatives. They throw Error(size |
/// argument), and Error(argument) for a model with dependent joints, because its M has entries between distant joints.
namespace cholesky {

/// Computes the factors of the M of the last crba(). O(n depth^2). Throws Error(singular), which names the joint, where M is singular.
inline void decompose(const CompactModel& model, Data& data) { detail::choleskyDecompose(model, data); }

/// Replaces X by M^-1 X.
template <detail::Writable T>
void solve(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::inverse, detail::columnsOf(X));
}
/// Replaces X by M X.
template <detail::Writable T>
void Mv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::mass_matrix, detail::columnsOf(X));
}
/// Replaces X by U X.
template <detail::Writable T>
void Uv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::upper, detail::columnsOf(X));
}
/// Replaces X by U^T X.
template <detail::Writable T>
void Utv(const CompactModel& model, Data& data, T&& X) {
  detail::choleskyTimes(model, data, detail::Product::transposed, detail::columnsOf(X));
}

}  // namespace cholesky

/// Estimates the condition number of M: how much accuracy is lost on the way from M to M^-1 and to accelerations. At 10^12 four digits of a
/// double are left, at 10^16 none. Each row and column is first divided by the root of its diagonal entry, so units and sizes of bodies do not
/// count. The estimate is a lower bound in the 1-norm, as a rule within a factor of three: Hager 1984, Higham 1988.
/// Reads the M of the last crba() and the factors of the last decompose(). O(n^2). For a model with dependent joints it factors M itself, O(n^3),
/// needs only Need::mass_matrix, and returns infinity if M is singular.
inline double conditionOfMassMatrix(const CompactModel& model, Data& data) { return detail::conditionOfMassMatrix(model, data); }

/// Computes ddq = M^-1 (tau - C v - g - dissipation) [rad/s^2, m/s^2] through crba and the factors of M. aba gives the same at about half the cost,
/// and its errors stay at a few roundings; here they grow with the condition of M. Leaves M and its factors for cholesky::solve. Throws as
/// decompose().
inline VectorResult forwardDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau) {
  return {detail::forwardDynamics(model, data, q, v, tau), model.nv()};
}

}  // namespace dyn
