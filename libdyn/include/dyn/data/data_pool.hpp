// Threads with a Data each: any algorithm of single states, for many.
//
//   dyn::DataPool pool(model, dyn::Need::derivatives, 4);
//   pool.forEach(Q.cols(), [&](dyn::Data& data, Eigen::Index k) {
//     Y.col(k) = dyn::computeJointTorqueRegressor(model, data, Q.col(k), V.col(k), A.col(k)).reshaped();
//   });
//
// For what has no overload for BatchData, which takes several states an instruction: regressors, kinematic derivatives, Cholesky factors, second
// derivatives, constraints.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

#include <cstddef>
#include <type_traits>

namespace dyn {

/// For one caller at a time. In a child of fork(), which has none of its parent's threads, the first call starts as many, and allocates.
class DYN_API DataPool {
 public:
  /// Throws Error(argument) unless threads is positive, or if the system gives fewer.
  explicit DataPool(const CompactModel& model, Need needs = Need::state, int threads = 1);
  ~DataPool();
  DataPool(DataPool&&) noexcept;
  DataPool& operator=(DataPool&&) noexcept;

  int threads() const;

  /// Calls f(data, k), or f(data, k, thread) for scratch of one's own, for each k in [0, count): each thread with its own Data and neighbours of k.
  /// Returns when all are done. What f throws for the smallest such k is thrown again, an Error with the state in its message; the other states
  /// are computed all the same.
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
