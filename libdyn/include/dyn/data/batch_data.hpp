// SPDX-License-Identifier: BSD-2-Clause
// Memory for the algorithms over many states at once (dyn/algorithm/batch.hpp).
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

#include <span>

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
  /// Takes memory for the results that `needs` names, and starts threads - 1 threads. Throws Error(argument) unless capacity and threads are
  /// positive, and if the system gives fewer threads. Throws Error(memory) if the machine has less memory than the batch needs.
  BasicBatchData(const CompactModel& model, int capacity, Need needs = Need::state, int threads = 1);
  ~BasicBatchData();
  BasicBatchData(BasicBatchData&&) noexcept;
  BasicBatchData& operator=(BasicBatchData&&) noexcept;
  BasicBatchData(const BasicBatchData&) = delete;
  BasicBatchData& operator=(const BasicBatchData&) = delete;

  /// Makes state k that of models[k] in all calls that follow, which then take at most as many states as there are models. No models: all states are
  /// of the batch's own model again. The models must come from that one by CompactModel::withNumbers() and differ in inertias only; otherwise throws
  /// Error(argument). Throws Error(size) for more models than `capacity`. O(models * n): a copy of numbers, after which the models may be destroyed.
  void setModels(std::span<const CompactModel> models);

  int capacity() const;       ///< largest number of states
  int threads() const;        ///< number of threads, the caller's included
  int lanes() const;          ///< number of states that one instruction computes
  std::size_t bytes() const;  ///< size in bytes

  /// Returns the implementation, which is internal to libdyn.
  /// @{
  BatchImpl<T>& impl() { return *impl_; }
  const BatchImpl<T>& impl() const { return *impl_; }
  /// @}

 private:
  Owned<BatchImpl<T>> impl_;
};

using BatchData = BasicBatchData<double>;      ///< a batch that computes in double
using BatchDataFloat = BasicBatchData<float>;  ///< a batch that computes in float

}  // namespace dyn
