// SPDX-License-Identifier: BSD-2-Clause
// Steps of many states of one model at once: rollouts of joint forces that are known beforehand.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/states.hpp>
#include <dyn/data/views.hpp>
#include <dyn/integrate/integrator.hpp>
#include <dyn/owned.hpp>

namespace dyn {

/// Integrates up to `capacity` states in the lanes of a batch, with the methods of Simulator that are explicit and take steps of a fixed size. There
/// are no contacts, constraints, limits or events: the accelerations are those of aba. Use Simulator for those. All memory is allocated by the
/// constructor.
class DYN_API BatchStepper {
 public:
  /// Throws Error(argument) unless the method is explicit_euler, semi_implicit_euler or rk4, and as BatchData for capacity and threads.
  BatchStepper(const CompactModel& model, int capacity, Integrator method, int threads = 1);
  ~BatchStepper();
  BatchStepper(BatchStepper&&) noexcept;
  BatchStepper& operator=(BatchStepper&&) noexcept;

  /// Advances states (nq x N and nv x N) by dt [s] under joint forces Tau (nv x N), one state per column, N at most `capacity`. Throws
  /// Error(size | argument) for arguments, and Error(singular) as aba, before Q and V change.
  void step(double dt, const detail::StatesArg<double>& Tau, const MatrixOut& Q, const MatrixOut& V) { advance(dt, Tau, Q, V); }

  /// Advances N states by one step for every N columns of Tau, and writes all states: step s of state k is column s N + k of Tau, Q (nq x N steps)
  /// and V (nv x N steps), where the result has the state at the end of the step. Q0 and V0 have the first states. Throws as step(); the steps before
  /// are written then.
  void rollout(double dt, const detail::StatesArg<double>& Q0, const detail::StatesArg<double>& V0, const detail::StatesArg<double>& Tau,
               const MatrixOut& Q, const MatrixOut& V) {
    run(dt, Q0, V0, Tau, Q, V);
  }

 private:
  struct Impl;
  void advance(double dt, detail::StatesView<double> tau, const MatrixOut& q, const MatrixOut& v);
  void run(double dt, detail::StatesView<double> q0, detail::StatesView<double> v0, detail::StatesView<double> tau, const MatrixOut& q,
           const MatrixOut& v);

  Owned<Impl> impl_;
};

}  // namespace dyn
