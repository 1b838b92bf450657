// The memory behind BatchData: scratch for each thread, results of each kind.
#pragma once

#include "data/kinematics_stage.hpp"
#include "data/workers.hpp"
#include "kernels/table.hpp"

#include <dyn/data/batch_data.hpp>

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

namespace dyn {

namespace detail {

/// The first state, in order, that something is wrong with.
struct Failure {
  int state = std::numeric_limits<int>::max();
  int body = 0;   ///< whose pivot vanished; 0: q may be no configuration
  int count = 1;  ///< it is this state or one of those after it
  void note(int s, int b, int n = 1) {
    if (s < state) *this = {s, b, n};
  }
};

}  // namespace detail

/// n x n numbers a state. Results that have entries only where a path to the root leads write no zeros, which may be most of what there is to write:
/// these stay from call to call, until something has been written whole.
template <class T>
class StateMatrices {
 public:
  void resize(std::size_t n, std::size_t states) {
    square_ = n * n;
    clear_ = states;
    numbers_.assign(square_ * states, T(0));
  }
  /// For results that are written whole.
  T* whole() {
    clear_ = 0;
    return numbers_.data();
  }
  /// For those of the first `states` that are written where paths are; the other numbers are zero.
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
  std::size_t clear_ = 0;  ///< of the first states all numbers off the paths are zero
};

/// A block of states of a model with couplings in expanded coordinates, and the derivatives of its couplings: columns, a state each.
template <class T>
struct ExpandedStates {
  std::vector<T> q, v, a, couplings;
  std::vector<double> given, expanded;  ///< numbers of one state, where T is another type

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
  std::vector<PackMemory> scratch;          ///< a thread each
  std::vector<detail::Failure> failures;    ///< a thread each, of the call that is under way
  std::vector<ExpandedStates<T>> expanded;  ///< a thread each, for models with couplings

  std::vector<T> tau, nle, gravity, ddq;  ///< nv numbers a state
  std::vector<T> J;                       ///< 6 * nv numbers a state
  StateMatrices<T> M;                     ///< of Need::mass_matrix
  StateMatrices<T> by_q, by_v, by_a;      ///< of Need::derivatives
  std::vector<T> maps[4];                 ///< 6 * nv numbers a state, of the same
  KinematicsStage stage = KinematicsStage::nothing;
  PackMemory poses, velocities, accelerations;  ///< by block of `lanes` states, then body, number, state

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
