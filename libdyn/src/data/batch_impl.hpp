// The memory behind BatchData: scratch for each thread, results of each kind.
#pragma once

#include "data/workers.hpp"
#include "kernels/table.hpp"

#include <dyn/data/batch_data.hpp>

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

template <class T>
struct BatchImpl {
  const CompactImpl* model = nullptr;
  std::shared_ptr<const CompactModel> keep;
  Need needs = Need::state;
  int capacity = 0;
  const kernels::BlockKernels<T>* kernels = nullptr;
  std::unique_ptr<Workers> workers;
  std::vector<PackMemory> scratch;        ///< a thread each
  std::vector<detail::Failure> failures;  ///< a thread each, of the call that is under way
  std::vector<Data> single;               ///< a thread each, for models with couplings
  std::vector<Eigen::VectorXd> columns;   ///< three a thread, for the same: q, v, a of one state

  std::vector<T> tau, nle, gravity, ddq;        ///< nv numbers a state
  std::vector<T> M;                             ///< nv * nv numbers a state
  std::vector<T> J;                             ///< 6 * nv numbers a state
  std::vector<T> by_q, by_v, by_a;              ///< nv * nv numbers a state, of Need::derivatives
  std::vector<T> maps[4];                       ///< 6 * nv numbers a state, of the same
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
