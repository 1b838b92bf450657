// SPDX-License-Identifier: BSD-2-Clause
// The memory of BatchData: scratch for each thread, and results.
#pragma once

#include "data/kinematics_stage.hpp"
#include "data/workers.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/data/batch_data.hpp>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

namespace dyn {

namespace detail {

/// The first state that failed, in the order of states.
struct Failure {
  int state = std::numeric_limits<int>::max();
  int body = 0;   ///< the body whose pivot vanished; 0: q may not be a configuration
  int count = 1;  ///< the failed state is one of this many, from `state` on
  void note(int s, int b, int n = 1) {
    if (s < state) *this = {s, b, n};
  }
};

}  // namespace detail

/// n x n numbers per state. Results with entries only on root paths do not write the other numbers, which may be most of the matrix. These stay zero
/// from call to call until a whole matrix has been written.
template <class T>
class StateMatrices {
 public:
  void resize(std::size_t n, std::size_t states) {
    square_ = n * n;
    clear_ = states;
    numbers_.assign(square_ * states, T(0));
  }
  /// The memory for results that write whole matrices.
  T* whole() {
    clear_ = 0;
    return numbers_.data();
  }
  /// The memory for results of the first `states` states that write only on root paths. The other numbers there are zero.
  T* onPaths(std::size_t states) {
    if (clear_ < states) std::fill(numbers_.begin() + difference(clear_), numbers_.begin() + difference(states), T(0));
    clear_ = std::max(clear_, states);
    return numbers_.data();
  }
  std::size_t bytes() const { return sizeof(T) * numbers_.size(); }

 private:
  std::ptrdiff_t difference(std::size_t states) const { return static_cast<std::ptrdiff_t>(square_ * states); }

  std::vector<T> numbers_;
  std::size_t square_ = 0;
  std::size_t clear_ = 0;  ///< in this many first states, all numbers off the root paths are zero
};

/// A block of states of a model with couplings in expanded coordinates, and the derivatives of its couplings. Arrays have one column per state.
template <class T>
struct ExpandedStates {
  std::vector<T> q, v, a, couplings;
  std::vector<double> given, expanded;  ///< numbers of one state in double, used if T is another type

  ExpandedStates(const CompactImpl& m, int lanes) {
    const auto states = static_cast<std::size_t>(lanes), nvx = static_cast<std::size_t>(m.nvx);
    q.resize(static_cast<std::size_t>(m.nqx) * states);
    v.resize(nvx * states);
    a.resize(nvx * states);
    couplings.resize(3 * m.couplings.size() * states);
    given.resize(static_cast<std::size_t>(m.nq + 2 * m.nv));
    expanded.resize(static_cast<std::size_t>(m.nqx) + 2 * nvx + 3 * m.couplings.size());
  }
  std::size_t bytes() const {
    return sizeof(T) * (q.size() + v.size() + a.size() + couplings.size()) + sizeof(double) * (given.size() + expanded.size());
  }
};

template <class T>
struct BatchImpl {
  const CompactImpl* model = nullptr;
  std::shared_ptr<const CompactModel> keep;
  Need needs = Need::state;
  int capacity = 0;
  const kernels::BlockKernels<T>* kernels = nullptr;
  std::unique_ptr<Workers> workers;
  std::vector<PackMemory> scratch;          ///< one per thread
  std::vector<detail::Failure> failures;    ///< one per thread, of the current call
  std::vector<ExpandedStates<T>> expanded;  ///< one per thread, for models with couplings

  std::vector<T> tau, nle, gravity, ddq;                     ///< nv numbers per state
  std::vector<T> J;                                          ///< 6 * nv numbers per state
  StateMatrices<T> M;                                        ///< with Need::mass_matrix
  StateMatrices<T> by_q, by_v, by_a;                         ///< with Need::derivatives
  std::vector<T> maps[4];                                    ///< 6 * nv numbers per state, with Need::derivatives
  std::vector<T> com[3];                                     ///< 3 numbers per state: position, velocity and acceleration
  std::vector<T> energies[2];                                ///< one number per state: kinetic, potential
  PackMemory factors;                                        ///< of M^-1, by block (kernels/derivative/tree_factors.hpp), with Need::derivatives
  int factored = 0;                                          ///< the number of states that have factors
  int models = 0;                                            ///< the first states have models of their own, if it is not 0
  bool massless = false;                                     ///< one of these models has no mass
  PackMemory inertias;                                       ///< of these models, ordered by block, body, number, state; empty for packs of one lane
  std::vector<std::shared_ptr<const CompactImpl>> by_state;  ///< packs of one lane: these models, in the frames of the batch's own
  KinematicsStage stage = KinematicsStage::nothing;
  int states = 0;                               ///< the number of states that reached the stage
  PackMemory poses, velocities, accelerations;  ///< ordered by block of `lanes` states, body, number, state

  int blocks() const { return (capacity + kernels->lanes - 1) / kernels->lanes; }
};

template <class T>
const kernels::BlockKernels<T>& blockKernelsOf(const kernels::Kernels& k) {
  if constexpr (std::is_same_v<T, float>) {
    return k.floats;
  } else {
    return k.doubles;
  }
}

}  // namespace dyn
