// Results of many states at once: columns of matrices are states.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/owned.hpp>

namespace dyn {

template <class T>
struct BatchImpl;

/// Scratch and results for 1 to `capacity` states of one model, in double or float; a call with none throws Error(size). All memory is taken
/// when it is made; it grows as the number of states. One batch is for one caller at a time; the threads it starts are its own. Results are the
/// same bits whatever their number. In a child of fork(), which has none of its parent's threads, the first call starts as many, and allocates.
template <class T>
class DYN_API BasicBatchData {
 public:
  /// Throws Error(argument) unless capacity and threads are positive, or if the system gives fewer threads.
  BasicBatchData(const CompactModel& model, int capacity, Need needs = Need::state, int threads = 1);
  ~BasicBatchData();
  BasicBatchData(BasicBatchData&&) noexcept;
  BasicBatchData& operator=(BasicBatchData&&) noexcept;
  BasicBatchData(const BasicBatchData&) = delete;
  BasicBatchData& operator=(const BasicBatchData&) = delete;

  int capacity() const;
  int threads() const;
  /// States that are computed by one instruction.
  int lanes() const;
  /// Bytes taken.
  std::size_t bytes() const;

  BatchImpl<T>& impl() { return *impl_; }
  const BatchImpl<T>& impl() const { return *impl_; }

 private:
  Owned<BatchImpl<T>> impl_;
};

using BatchData = BasicBatchData<double>;
using BatchDataFloat = BasicBatchData<float>;

}  // namespace dyn
