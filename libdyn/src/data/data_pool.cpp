// SPDX-License-Identifier: BSD-2-Clause
#include "data/workers.hpp"

#include <dyn/data/data_pool.hpp>
#include <dyn/error.hpp>

#include <exception>
#include <string>
#include <vector>

namespace dyn {

namespace {
int checked(int threads) {
  if (threads < 1) throw Error(ErrorCode::argument, "DataPool: " + std::to_string(threads) + " threads; there must be at least one");
  return threads;
}
}  // namespace

struct DataPool::Impl {
  struct Place {
    Data data;
    std::ptrdiff_t failed = 0;  ///< the first state that failed, if `why` is set
    std::exception_ptr why;
    Place(const CompactModel& model, Need needs) : data(model, needs) {}
  };
  std::vector<Place> places;  ///< one per thread
  Workers workers;

  Impl(const CompactModel& model, Need needs, int threads) : workers(checked(threads)) {
    for (int i = 0; i < threads; ++i) places.emplace_back(model, needs);
  }
};

DataPool::DataPool(const CompactModel& model, Need needs, int threads) : impl_(std::make_unique<Impl>(model, needs, threads)) {}
DataPool::~DataPool() = default;
DataPool::DataPool(DataPool&&) noexcept = default;
DataPool& DataPool::operator=(DataPool&&) noexcept = default;

int DataPool::threads() const { return impl_->workers.count(); }

void DataPool::each(std::ptrdiff_t count, void (*call)(void*, Data&, std::ptrdiff_t, int), void* context) {
  const std::ptrdiff_t threads = impl_->workers.count();
  impl_->workers.run([&](int t) {
    Impl::Place& place = impl_->places[static_cast<std::size_t>(t)];
    place.why = nullptr;
    for (std::ptrdiff_t k = count * t / threads; k < count * (t + 1) / threads; ++k) {
      try {
        call(context, place.data, k, t);
      } catch (...) {
        if (place.why) continue;
        place.failed = k;
        place.why = std::current_exception();
      }
    }
  });
  // Later threads have later states, so the first thread that failed has the first failed state.
  for (const Impl::Place& place : impl_->places) {
    if (!place.why) continue;
    try {
      std::rethrow_exception(place.why);
    } catch (const Error& e) {
      const std::size_t prefix = std::string(Error(e.code(), "", e.where()).what()).size();
      throw Error(e.code(), "state " + std::to_string(place.failed) + ": " + std::string(e.what()).substr(prefix), e.where());
    }
  }
}

}  // namespace dyn
