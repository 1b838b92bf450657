// SPDX-License-Identifier: BSD-2-Clause
// Threads with one Data each. They run any algorithm of single states for many states.
//
//   dyn::DataPool pool(model, dyn::Need::derivatives, 4);
//   pool.forEach(Q.cols(), [&](dyn::Data& data, Eigen::Index k) {
//     Y.col(k) = dyn::computeJointTorqueRegressor(model, data, Q.col(k), V.col(k), A.col(k)).reshaped();
//   });
//
// Use a pool for algorithms that have no overload for BatchData: regressors, kinematic derivatives, Cholesky factors, second derivatives,
// constraints. A BatchData computes several states per instruction.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

#include <cstddef>
#include <type_traits>

namespace dyn {

/// A pool of threads with one Data each. Only one caller may use a pool at a time. A child of fork()
/// has none of its parent's threads, so its first call starts as many anew, and allocates.
class DYN_API DataPool {
 public:
  /// Allocates a Data for each thread, and starts threads - 1 threads. Throws Error(argument) unless threads is positive, and if the system gives
  /// fewer threads. Throws Error(memory) if the machine has less memory than the Data need.
  explicit DataPool(const CompactModel& model, Need needs = Need::state, int threads = 1);
  ~DataPool();
  DataPool(DataPool&&) noexcept;
  DataPool& operator=(DataPool&&) noexcept;

  int threads() const;  ///< number of threads, the caller's included

  /// Calls f(data, k), or f(data, k, thread) if f has scratch of its own per thread, for each k in [0, count). Each thread has its own Data and a
  /// contiguous range of k. Returns when all calls are done. If f throws for some k, the other states are computed all the same, and the exception
  /// of the smallest such k is thrown again; an Error then names the state in its message.
  template <class F>
  void forEach(std::ptrdiff_t count, F&& f) {
    auto call = [&f](Data& data, std::ptrdiff_t k, int thread) {
      if constexpr (std::is_invocable_v<F, Data&, std::ptrdiff_t, int>) {
        f(data, k, thread);
      } else {
        f(data, k);
      }
    };
    each(
        count, [](void* context, Data& data, std::ptrdiff_t k, int thread) { (*static_cast<decltype(call)*>(context))(data, k, thread); }, &call);
  }

 private:
  void each(std::ptrdiff_t count, void (*call)(void* context, Data& data, std::ptrdiff_t k, int thread), void* context);

  struct Impl;
  Owned<Impl> impl_;
};

}  // namespace dyn
