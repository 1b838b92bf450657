// SPDX-License-Identifier: BSD-2-Clause
// Memory for all results and intermediate values of one state.
#pragma once

#include <dyn/catalogue/need.hpp>
#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>
#include <dyn/owned.hpp>

namespace dyn {

struct DataImpl;

/// Scratch and results for one thread and one model. It shares the model, which may go out of scope before it.
/// Calls that throw, and numbers that are not finite, leave nothing behind: the next call gives the results that it would give with new Data.
class DYN_API Data {
 public:
  /// Allocates all memory, with that for the results that `needs` names. Throws Error(memory) if the machine has less.
  explicit Data(const CompactModel& model, Need needs = Need::state);
  ~Data();
  Data(Data&&) noexcept;
  Data& operator=(Data&&) noexcept;
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  std::size_t bytes() const;  ///< size in bytes

  /// Returns the implementation, which is internal to libdyn.
  /// @{
  DataImpl& impl() { return *impl_; }
  const DataImpl& impl() const { return *impl_; }
  /// @}

 private:
  Owned<DataImpl> impl_;
};

}  // namespace dyn
