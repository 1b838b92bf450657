// SPDX-License-Identifier: BSD-2-Clause
// Derivatives, inverse mass matrices, Coriolis matrices and centroidal quantities of many states.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/centroidal.hpp>
#include <dyn/algorithm/derivatives.hpp>

namespace dyn {

/// Results of computeRNEADerivatives for a batch. Each column is one state's matrix, as RNEADerivatives has it.
template <class T>
struct BatchRNEADerivatives {
  detail::StatesResult<T> dtau_dq,  ///< of tau by q, nv * nv numbers per state
      dtau_dv,                      ///< of tau by v, nv * nv
      dtau_da;                      ///< M, nv * nv
};
/// Results of computeABADerivatives for a batch. Each column is one state's vector or matrix, as ABADerivatives has it.
template <class T>
struct BatchABADerivatives {
  detail::StatesResult<T> ddq;     ///< nv numbers per state
  detail::StatesResult<T> ddq_dq,  ///< of ddq by q, nv * nv numbers per state
      ddq_dv,                      ///< of ddq by v, nv * nv
      ddq_dtau;                    ///< M^-1, nv * nv
};
/// Results of ccrba for a batch. Each column is one state's vector or matrix, as CentroidalMomentum has it.
template <class T>
struct BatchCentroidalMomentum {
  detail::StatesResult<T> hg,  ///< momentum, 6 numbers per state
      Ag;                      ///< its map, 6 * nv
};
/// Results of computeCentroidalMomentumTimeVariation for a batch. Each column is one state's vector or matrix, as CentroidalRate has it.
template <class T>
struct BatchCentroidalRate {
  detail::StatesResult<T> hg,  ///< momentum, 6 numbers per state
      dhg,                     ///< its rate, 6
      Ag,                      ///< its map, 6 * nv
      dAg;                     ///< the map's rate, 6 * nv
};
/// Results of computeCentroidalDynamicsDerivatives for a batch. Each column is one state's matrix, as CentroidalDerivatives has it.
template <class T>
struct BatchCentroidalDerivatives {
  detail::StatesResult<T> dhg_dq,  ///< of the momentum by q, 6 * nv numbers per state
      dhgdot_dq,                   ///< of its rate by q, 6 * nv
      dhgdot_dv,                   ///< of its rate by v, 6 * nv
      dhgdot_da;                   ///< of its rate by a: Ag, 6 * nv
};

/// Computes the derivatives of rnea in every state. This and the functions below need a batch made with Need::derivatives, and throw
/// Error(size | argument) as runAlgorithm does.
template <class T>
BatchRNEADerivatives<T> computeRNEADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                               const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::rnea_derivatives, Q, V, A);
  return {x(0), x(1), x(2)};
}
/// Computes dg/dq of generalizedGravity in every state, nv * nv numbers per state.
template <class T>
detail::StatesResult<T> computeGeneralizedGravityDerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::rnea_derivatives, Q, {}, {})(0);
}
/// Computes the derivatives of aba in every state. Throws Error(singular), which names the joint and the state, where M is singular. The columns of
/// such states are NaN; the others are right.
template <class T>
BatchABADerivatives<T> computeABADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                             const detail::States<T>& V, const detail::States<T>& Tau) {
  const auto x = detail::runBatch<T>(model, data, Algorithm::aba_derivatives, Q, V, Tau);
  return {x(3), x(0), x(1), x(2)};
}
/// Computes M^-1 in every state, nv * nv numbers per state. Throws as computeABADerivatives.
template <class T>
detail::StatesResult<T> computeMinverse(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::minverse, Q, {}, {})(0);
}
/// Computes the Coriolis matrix C in every state, nv * nv numbers per state.
template <class T>
detail::StatesResult<T> computeCoriolisMatrix(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                              const detail::States<T>& V) {
  return detail::runBatch<T>(model, data, Algorithm::coriolis, Q, V, {})(0);
}
/// Computes centroidal momenta and their maps, their rates, or their derivatives in every state, as the function of the same name does for one.
/// Throws Error(singular) for a model without mass.
/// @{
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
/// @}

}  // namespace dyn
