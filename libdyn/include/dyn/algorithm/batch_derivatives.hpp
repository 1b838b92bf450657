// SPDX-License-Identifier: BSD-2-Clause
// Derivatives, inverse mass matrices, Coriolis matrices and centroidal quantities of many states. Each column of an argument is one state. Each
// column of a result is a matrix, as the function of the same name writes it for one state. The batch must have been made with
// Need::derivatives. It owns the results until its next call. The centroidal functions throw Error(singular) for a model without mass.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/centroidal.hpp>
#include <dyn/algorithm/derivatives.hpp>

namespace dyn {

template <class T>
struct BatchRNEADerivatives {
  detail::StatesResult<T> dtau_dq, dtau_dv, dtau_da;  ///< nv * nv numbers per state
};
template <class T>
struct BatchABADerivatives {
  detail::StatesResult<T> ddq;                       ///< nv numbers per state
  detail::StatesResult<T> ddq_dq, ddq_dv, ddq_dtau;  ///< nv * nv numbers per state
};
template <class T>
struct BatchCentroidalMomentum {
  detail::StatesResult<T> hg, Ag;  ///< 6 and 6 * nv numbers per state
};
template <class T>
struct BatchCentroidalRate {
  detail::StatesResult<T> hg, dhg, Ag, dAg;  ///< 6, 6, 6 * nv and 6 * nv numbers per state
};
template <class T>
struct BatchCentroidalDerivatives {
  detail::StatesResult<T> dhg_dq, dhgdot_dq, dhgdot_dv, dhgdot_da;  ///< 6 * nv numbers per state
};

template <class T>
BatchRNEADerivatives<T> computeRNEADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                               const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::rnea_derivatives, Q, V, A);
  return {x(0), x(1), x(2)};
}
/// dg/dq, nv * nv numbers per state.
template <class T>
detail::StatesResult<T> computeGeneralizedGravityDerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::rnea_derivatives, Q, {}, {})(0);
}
/// Throws Error(singular), which names the joint and the state, where M is singular. The columns of such states are NaN; the others are right.
template <class T>
BatchABADerivatives<T> computeABADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                             const detail::States<T>& V, const detail::States<T>& Tau) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::aba_derivatives, Q, V, Tau);
  return {x(3), x(0), x(1), x(2)};
}
/// M^-1, nv * nv numbers per state. Throws as computeABADerivatives.
template <class T>
detail::StatesResult<T> computeMinverse(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::minverse, Q, {}, {})(0);
}
/// C, nv * nv numbers per state.
template <class T>
detail::StatesResult<T> computeCoriolisMatrix(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                              const detail::States<T>& V) {
  return detail::runBatch<T>(model, data, Algorithm::coriolis, Q, V, {})(0);
}
template <class T>
BatchCentroidalMomentum<T> ccrba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::centroidal_map, Q, V, {});
  return {x(0), x(1)};
}
template <class T>
BatchCentroidalRate<T> computeCentroidalMomentumTimeVariation(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                                              const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::centroidal_rate, Q, V, A);
  return {x(0), x(1), x(2), x(3)};
}
template <class T>
BatchCentroidalDerivatives<T> computeCentroidalDynamicsDerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                                                   const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::centroidal_derivatives, Q, V, A);
  return {x(0), x(1), x(2), x(3)};
}

}  // namespace dyn
