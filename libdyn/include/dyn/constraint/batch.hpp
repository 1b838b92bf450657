// SPDX-License-Identifier: BSD-2-Clause
// Constrained dynamics and impacts of many states at once, all under the same constraints.
#pragma once

#include <dyn/algorithm/batch.hpp>
#include <dyn/constraint/constraint_set.hpp>

#include <span>

namespace dyn {

struct BatchConstraintImpl;

/// Scratch and results of a set of constraints for the states of a batch. The constructor takes all memory.
class DYN_API BatchConstraintData {
 public:
  /// Takes memory for calls with this batch, or with other batches of its model that have no more states and threads. Throws Error(argument) if the
  /// set was looked up in another model, and for a model with dependent joints. Throws Error(memory) if the machine has less memory than this needs.
  BatchConstraintData(const ConstraintSet& set, const BatchData& batch);
  ~BatchConstraintData();
  BatchConstraintData(BatchConstraintData&&) noexcept;
  BatchConstraintData& operator=(BatchConstraintData&&) noexcept;
  BatchConstraintData(const BatchConstraintData&) = delete;
  BatchConstraintData& operator=(const BatchConstraintData&) = delete;

  /// Returns the constraints.
  const ConstraintSet& set() const;
  ConstraintSettings settings;  ///< may be changed between calls

  /// Returns the memory taken, in bytes.
  std::size_t bytes() const;
  /// Returns the implementation, which is internal to libdyn.
  /// @{
  BatchConstraintImpl& impl() { return *impl_; }
  const BatchConstraintImpl& impl() const { return *impl_; }
  /// @}

 private:
  Owned<BatchConstraintImpl> impl_;
};

/// Results of constraintDynamics for a batch. Each column and each entry belongs to one state, as ConstrainedMotion has it.
struct BatchConstrainedMotion {
  detail::StatesResult<double> ddq,  ///< accelerations [rad/s^2, m/s^2], nv x N
      lambda;                        ///< forces of the rows [N, N m], rows x N
  std::span<const double> residual;  ///< [m/s^2, rad/s^2]
  std::span<const int> rank,         ///< of the rows
      iterations;                    ///< of the solver for lambda
};
/// Results of impulseDynamics for a batch. Each column and each entry belongs to one state, as ConstrainedImpact has it.
struct BatchConstrainedImpact {
  detail::StatesResult<double> v_after,  ///< velocities [rad/s, m/s], nv x N
      impulse;                           ///< impulses of the rows [N s, N m s], rows x N
  std::span<const double> residual;      ///< [m/s, rad/s]
  std::span<const int> rank;             ///< of the rows
};

namespace detail {
struct BatchConstrainedViews {
  const double *motion, *forces, *residual;
  const int *rank, *iterations;
};
DYN_API BatchConstrainedViews batchConstraintDynamics(const CompactModel&, BatchData&, StatesView<double> q, StatesView<double> v,
                                                      StatesView<double> tau, BatchConstraintData&);
DYN_API BatchConstrainedViews batchImpulseDynamics(const CompactModel&, BatchData&, StatesView<double> q, StatesView<double> v, double restitution,
                                                   BatchConstraintData&);
}  // namespace detail

/// Computes accelerations and constraint forces in every state, as constraintDynamics does for one by its articulated method. The constraints' data
/// owns the results until its next call. Throws Error(size | argument) as the functions of batch.hpp, and Error(singular), which names the joint and
/// the state, where M is singular. The columns of such states are NaN; the others are right. O(n + rows^3) a state.
inline BatchConstrainedMotion constraintDynamics(const CompactModel& model, BatchData& data, const detail::States<double>& Q,
                                                 const detail::States<double>& V, const detail::States<double>& Tau,
                                                 BatchConstraintData& constraints) {
  const detail::StatesView<double> q = Q;
  const detail::BatchConstrainedViews x = detail::batchConstraintDynamics(model, data, q, V, Tau, constraints);
  const auto states = static_cast<std::size_t>(q.cols);
  return {
      {x.motion, model.nv(), q.cols}, {x.forces, constraints.set().rows(), q.cols}, {x.residual, states}, {x.rank, states}, {x.iterations, states}};
}

/// Computes velocities after impacts, and their impulses, in every state, as impulseDynamics does for one. Throws as constraintDynamics above, and
/// Error(argument) unless restitution is in [0, 1].
inline BatchConstrainedImpact impulseDynamics(const CompactModel& model, BatchData& data, const detail::States<double>& Q,
                                              const detail::States<double>& V, double restitution, BatchConstraintData& constraints) {
  const detail::StatesView<double> q = Q;
  const detail::BatchConstrainedViews x = detail::batchImpulseDynamics(model, data, q, V, restitution, constraints);
  const auto states = static_cast<std::size_t>(q.cols);
  return {{x.motion, model.nv(), q.cols}, {x.forces, constraints.set().rows(), q.cols}, {x.residual, states}, {x.rank, states}};
}

}  // namespace dyn
