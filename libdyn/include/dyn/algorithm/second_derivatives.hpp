// Second derivatives of inverse dynamics.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct SecondDerivativeImpl;

/// Scratch and results of n^3 numbers each, for one thread. All memory is taken when it is made.
class DYN_API SecondDerivativeData {
 public:
  explicit SecondDerivativeData(const CompactModel& model);
  ~SecondDerivativeData();
  SecondDerivativeData(SecondDerivativeData&&) noexcept;
  SecondDerivativeData& operator=(SecondDerivativeData&&) noexcept;
  SecondDerivativeData(const SecondDerivativeData&) = delete;
  SecondDerivativeData& operator=(const SecondDerivativeData&) = delete;

  std::size_t bytes() const;
  SecondDerivativeImpl& impl() { return *impl_; }

 private:
  Owned<SecondDerivativeImpl> impl_;
};

/// n matrices of n x n: [k](i, j) is the change along degree of freedom k of the derivative of tau_i by the j-th.
struct TensorResult {
  const double* data;
  int n;
  MatrixResult operator[](int k) const { return {data + static_cast<std::ptrdiff_t>(k) * n * n, n, n}; }
};

/// q in its tangent space, each derivative at the q that the one before has led to: d2tau_dqdq is not symmetric in its two directions where
/// motions do not commute.
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

/// Of rnea(q, v, a), for every joint type: the recursion of computeRNEADerivatives on dual numbers, once a direction. O(n^2 depth).
/// Needs Need::derivatives. Throws Error(size | argument), the latter for models with joints that follow others, too.
inline RneaSecondDerivatives computeRNEASecondOrderDerivatives(const CompactModel& model, Data& data, SecondDerivativeData& second,
                                                               const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  const detail::SecondDerivativeViews x = detail::rneaSecondDerivatives(model, data, second, q, v, a);
  const int n = model.nv();
  return {{x.qq, n}, {x.qv, n}, {x.vv, n}, {x.aq, n}};
}

}  // namespace dyn
