// Derivatives, inverse inertias, Coriolis matrices and centroidal quantities of many states. Columns are states; each column of a result
// is a matrix, written as the function of the same name writes it for one state. The batch must have been made with Need::derivatives, and
// owns the results until its next call of any of these functions.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/algorithm/centroidal.hpp>
#include <dyn/algorithm/derivatives.hpp>

namespace dyn {

namespace detail {
enum class BatchDerivatives { rnea, aba, minverse, coriolis, centroidal_map, centroidal_rate, centroidal_derivatives };
template <class T>
struct BatchDerivativeViews {
  const T* results[4];
  std::ptrdiff_t states;
  StatesResult<T> operator()(int result, Eigen::Index rows) const { return {results[result], rows, states}; }
};
template <class T>
DYN_API BatchDerivativeViews<T> batchDerivatives(const CompactModel&, BasicBatchData<T>&, BatchDerivatives, StatesView<T> q, StatesView<T> v,
                                                 StatesView<T> a);
}  // namespace detail

template <class T>
struct BatchRneaDerivatives {
  detail::StatesResult<T> dtau_dq, dtau_dv, dtau_da;  ///< nv * nv numbers a state
};
template <class T>
struct BatchAbaDerivatives {
  detail::StatesResult<T> ddq;                       ///< nv numbers a state
  detail::StatesResult<T> ddq_dq, ddq_dv, ddq_dtau;  ///< nv * nv
};
template <class T>
struct BatchCentroidalMomentum {
  detail::StatesResult<T> hg, Ag;  ///< 6, and 6 * nv numbers a state
};
template <class T>
struct BatchCentroidalRate {
  detail::StatesResult<T> hg, dhg, Ag, dAg;
};
template <class T>
struct BatchCentroidalDerivatives {
  detail::StatesResult<T> dhg_dq, dhgdot_dq, dhgdot_dv, dhgdot_da;  ///< 6 * nv numbers a state
};

template <class T>
BatchRneaDerivatives<T> computeRNEADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                               const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::rnea, Q, V, A);
  const Eigen::Index n = Eigen::Index(model.nv()) * model.nv();
  return {x(0, n), x(1, n), x(2, n)};
}
/// nv * nv numbers a state.
template <class T>
detail::StatesResult<T> computeGeneralizedGravityDerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::rnea, Q, {}, {})(0, Eigen::Index(model.nv()) * model.nv());
}
/// Throws Error(singular) naming joint and state, whose columns are NaN; the others are right. So do the next two.
template <class T>
BatchAbaDerivatives<T> computeABADerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                             const detail::States<T>& V, const detail::States<T>& Tau) {
  const auto x = detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::aba, Q, V, Tau);
  const Eigen::Index n = Eigen::Index(model.nv()) * model.nv();
  return {x(3, model.nv()), x(0, n), x(1, n), x(2, n)};
}
/// nv * nv numbers a state.
template <class T>
detail::StatesResult<T> computeMinverse(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::minverse, Q, {}, {})(0, Eigen::Index(model.nv()) * model.nv());
}
/// nv * nv numbers a state.
template <class T>
detail::StatesResult<T> computeCoriolisMatrix(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                              const detail::States<T>& V) {
  return detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::coriolis, Q, V, {})(0, Eigen::Index(model.nv()) * model.nv());
}
template <class T>
BatchCentroidalMomentum<T> ccrba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  const auto x = detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::centroidal_map, Q, V, {});
  return {x(0, 6), x(1, 6 * model.nv())};
}
template <class T>
BatchCentroidalRate<T> computeCentroidalMomentumTimeVariation(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                                              const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::centroidal_rate, Q, V, A);
  return {x(0, 6), x(1, 6), x(2, 6 * model.nv()), x(3, 6 * model.nv())};
}
template <class T>
BatchCentroidalDerivatives<T> computeCentroidalDynamicsDerivatives(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q,
                                                                   const detail::States<T>& V, const detail::States<T>& A) {
  const auto x = detail::batchDerivatives<T>(model, data, detail::BatchDerivatives::centroidal_derivatives, Q, V, A);
  const Eigen::Index n = 6 * model.nv();
  return {x(0, n), x(1, n), x(2, n), x(3, n)};
}

}  // namespace dyn
