// Every result and intermediate of one state. All memory is taken when it is made.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/need.hpp>
#include <dyn/data/views.hpp>

namespace dyn {

struct DataImpl;

/// Scratch and results for one thread. Belongs to the model it was made for.
class DYN_API Data {
 public:
  explicit Data(const CompactModel& model, Need needs = Need::state);
  ~Data();
  Data(Data&&) noexcept;
  Data& operator=(Data&&) noexcept;
  Data(const Data&) = delete;
  Data& operator=(const Data&) = delete;

  /// Bytes taken.
  std::size_t bytes() const;

  DataImpl& impl() { return *impl_; }
  const DataImpl& impl() const { return *impl_; }

 private:
  std::unique_ptr<DataImpl> impl_;
};

}  // namespace dyn
