// SPDX-License-Identifier: BSD-2-Clause
// One thread's work: samples and chunks of them.
#pragma once

#include "store.hpp"
#include "task.hpp"

#include <optional>

namespace dyn::tool::sweep {

class Worker {
 public:
  /// Throws Error for a study whose results or predicate do not exist.
  explicit Worker(const Setting& setting);

  /// All results of a sample: failed, success, the inputs if they are kept, and those of the task.
  const std::vector<Field>& fields() const { return fields_; }
  Task& task() { return *task_; }

  /// Makes ready what samples need, which sample() does as well. Throws if no sample can be computed, unless a signal has arrived.
  void prepare();
  /// Computes consecutive samples, each with the same bytes as alone. Returns why some failed; the results of these are NaN. Throws if no sample can
  /// be computed.
  std::vector<std::optional<std::string>> samples(std::int64_t first, std::int64_t count, double* rows);
  /// Computes one sample. Returns why it failed.
  std::optional<std::string> sample(std::int64_t sample, double* row) { return samples(sample, 1, row)[0]; }
  /// The number of samples that should be computed together, so that they take little memory.
  std::int64_t together() const { return together_; }
  /// Computes a chunk. Returns nothing if a signal arrives meanwhile.
  std::optional<Chunk> chunk(std::int64_t first, std::int64_t count);

 private:
  /// Bounds on a result, by which success is decided.
  struct Bound {
    std::size_t first;  ///< place in the row
    std::vector<double> low, high;
  };
  void readSuccess();
  /// Judges the results of a sample. Returns why it failed.
  std::optional<std::string> finish(std::optional<std::string> reason, double* row) const;

  const Setting& setting_;
  std::unique_ptr<Task> task_;
  std::vector<Field> fields_;
  std::vector<Bound> bounds_;
  std::size_t inputs_ = 0;  ///< numbers of inputs that are kept
  std::int64_t together_ = 1;
};

}  // namespace dyn::tool::sweep
