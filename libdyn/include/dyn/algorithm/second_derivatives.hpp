// SPDX-License-Identifier: BSD-2-Clause
// Second derivatives of inverse dynamics.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct SecondDerivativeImpl;

/// Scratch and results, n^3 numbers for each result, for one thread. The constructor allocates all memory.
class DYN_API SecondDerivativeData {
 public:
  /// Takes 4 n^3 numbers for the results, and scratch.
  explicit SecondDerivativeData(const CompactModel& model);
  ~SecondDerivativeData();
  SecondDerivativeData(SecondDerivativeData&&) noexcept;
  SecondDerivativeData& operator=(SecondDerivativeData&&) noexcept;
  SecondDerivativeData(const SecondDerivativeData&) = delete;
  SecondDerivativeData& operator=(const SecondDerivativeData&) = delete;

  /// Returns the memory taken, in bytes.
  std::size_t bytes() const;
  SecondDerivativeImpl& impl() { return *impl_; }  ///< implementation, internal to libdyn

 private:
  Owned<SecondDerivativeImpl> impl_;
};

/// A view of n matrices of n x n. [k](i, j) is the change, along degree of freedom k, of the derivative of tau_i by the j-th variable.
struct TensorResult {
  const double* data;  ///< n^3 numbers: matrix after matrix, each column-major
  int n;               ///< nv
  /// Returns matrix k, without a check of k.
  MatrixResult operator[](int k) const { return {data + static_cast<std::ptrdiff_t>(k) * n * n, n, n}; }
};

/// Second derivatives of rnea. Those by q are in its tangent space. The first derivative is in the tangent space at the q that has moved along
/// direction k, so d2tau_dqdq is not symmetric in its two directions where motions do not commute.
struct RneaSecondDerivatives {
  TensorResult d2tau_dqdq;  ///< [k] = d(dtau/dq)/dq_k
  TensorResult d2tau_dqdv;  ///< [k] = d(dtau/dv)/dq_k
  TensorResult d2tau_dvdv;  ///< [k] = d(dtau/dv)/dv_k
  TensorResult d2tau_dadq;  ///< [k] = dM/dq_k
};

namespace detail {
struct SecondDerivativeViews {
  const double *qq, *qv, *vv, *aq;
};
DYN_API SecondDerivativeViews rneaSecondDerivatives(const CompactModel&, Data&, SecondDerivativeData&, VectorView q, VectorView v, VectorView a);
}  // namespace detail

/// Computes the second derivatives of rnea(q, v, a), for every joint type. It runs the recursion of computeRNEADerivatives on dual numbers, once
/// per direction. O(n^2 depth). Needs Need::derivatives. Throws Error(size | argument), the latter also for a model with dependent joints.
inline RneaSecondDerivatives computeRNEASecondOrderDerivatives(const CompactModel& model, Data& data, SecondDerivativeData& second,
                                                               const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  const detail::SecondDerivativeViews x = detail::rneaSecondDerivatives(model, data, second, q, v, a);
  const int n = model.nv();
  return {{x.qq, n}, {x.qv, n}, {x.vv, n}, {x.aq, n}};
}

}  // namespace dyn
