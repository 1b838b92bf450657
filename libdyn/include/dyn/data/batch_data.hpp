// SPDX-License-Identifier: BSD-2-Clause
// Memory for the algorithms over many states at once (dyn/algorithm/batch.hpp).
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

template <class T>
struct BatchImpl;

/// Scratch and results for 1 to `capacity` states of one model, in double or float. A call with no states throws Error(size). The constructor
/// allocates all memory, which grows with the number of states. Only one caller may use a batch at a time. A batch starts its own threads; their
/// number does not change a bit of the results. A child of fork() has none of its parent's threads, so its first call starts as many anew, and
/// allocates.
template <class T>
class DYN_API BasicBatchData {
 public:
  /// Throws Error(argument) unless capacity and threads are positive, and if the system gives fewer threads. Throws Error(memory) if the machine has
  /// less memory than the batch needs.
  BasicBatchData(const CompactModel& model, int capacity, Need needs = Need::state, int threads = 1);
  ~BasicBatchData();
  BasicBatchData(BasicBatchData&&) noexcept;
  BasicBatchData& operator=(BasicBatchData&&) noexcept;
  BasicBatchData(const BasicBatchData&) = delete;
  BasicBatchData& operator=(const BasicBatchData&) = delete;

  int capacity() const;
  int threads() const;
  /// Returns how many states one instruction computes.
  int lanes() const;
  /// Returns the size in bytes.
  std::size_t bytes() const;

  BatchImpl<T>& impl() { return *impl_; }
  const BatchImpl<T>& impl() const { return *impl_; }

 private:
  Owned<BatchImpl<T>> impl_;
};

using BatchData = BasicBatchData<double>;
using BatchDataFloat = BasicBatchData<float>;

}  // namespace dyn
