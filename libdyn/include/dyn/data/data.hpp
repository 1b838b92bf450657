// SPDX-License-Identifier: BSD-2-Clause
// Memory for all results and intermediate values of one state.
#pragma once

#include <dyn/catalogue/need.hpp>
#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct DataImpl;

/// Scratch and results for one thread and one model. The constructor allocates all memory and throws Error(memory) if the machine has less.
/// Calls that throw, and numbers that are not finite, leave nothing behind: the next call gives the results that it would give with new Data.
class DYN_API Data {
 public:
  explicit Data(const CompactModel& model, Need needs = Need::state);
  ~Data();
  Data(Data&&) noexcept;
  Data& operator=(Data&&) noexcept;
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  /// Returns the size in bytes.
  std::size_t bytes() const;

  DataImpl& impl() { return *impl_; }
  const DataImpl& impl() const { return *impl_; }

 private:
  Owned<DataImpl> impl_;
};

}  // namespace dyn
