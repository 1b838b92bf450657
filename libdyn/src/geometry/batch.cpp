// SPDX-License-Identifier: BSD-2-Clause
#include "data/workers.hpp"
#include "geometry/geometry_impl.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

namespace dyn {

struct GeometryBatchImpl {
  struct Scratch {
    Data data;
    GeometryData geometry;
    std::string error;
    std::ptrdiff_t failed = -1;  ///< first state that could not be computed
  };
  GeometryModel geometry;
  std::vector<Scratch> scratch;
  Workers workers;
  std::vector<unsigned char> flags;
  std::atomic<std::ptrdiff_t> next{0};

  GeometryBatchImpl(const CompactModel& model, const GeometryModel& g, int states, int threads)
      : geometry(g), workers(threads), flags(static_cast<std::size_t>(states)) {
    for (int i = 0; i < threads; ++i) scratch.push_back({Data(model), GeometryData(g, 0), "", -1});
  }
};

namespace {
std::unique_ptr<GeometryBatchImpl> made(const CompactModel& model, const GeometryModel& geometry, int capacity, int threads) {
  if (capacity <= 0 || threads <= 0)
    throw Error(ErrorCode::argument,
                "GeometryBatch: capacity " + std::to_string(capacity) + " and threads " + std::to_string(threads) + " must be positive");
  return std::make_unique<GeometryBatchImpl>(model, geometry, capacity, threads);
}
}  // namespace

GeometryBatch::GeometryBatch(const CompactModel& model, const GeometryModel& geometry, int capacity, int threads)
    : impl_(made(model, geometry, capacity, threads)) {}
GeometryBatch::~GeometryBatch() = default;
GeometryBatch::GeometryBatch(GeometryBatch&&) noexcept = default;
GeometryBatch& GeometryBatch::operator=(GeometryBatch&&) noexcept = default;
int GeometryBatch::capacity() const { return static_cast<int>(impl_->flags.size()); }

namespace detail {

const unsigned char* batchCollisions(const CompactModel& model, GeometryBatch& batch, StatesView<double> q) {
  GeometryBatchImpl& b = batch.impl();
  if (q.rows != model.nq() || q.cols > batch.capacity())
    throw Error(ErrorCode::size, "computeCollisions: Q is " + std::to_string(q.rows) + " x " + std::to_string(q.cols) + "; it needs nq = " +
                                     std::to_string(model.nq()) + " rows and at most " + std::to_string(batch.capacity()) + " columns");
  // The cost of a state varies widely, so each worker takes the next few states when it is done.
  constexpr std::ptrdiff_t share = 16;
  b.next = 0;
  for (auto& s : b.scratch) s.failed = -1;
  b.workers.run([&](int worker) {
    GeometryBatchImpl::Scratch& s = b.scratch[static_cast<std::size_t>(worker)];
    for (std::ptrdiff_t first = b.next.fetch_add(share); first < q.cols; first = b.next.fetch_add(share)) {
      for (std::ptrdiff_t k = first; k < std::min(first + share, q.cols); ++k) {
        try {
          const double* state = q.data + k * q.stride;
          for (std::ptrdiff_t i = 0; i < q.rows; ++i)
            if (!std::isfinite(state[i])) throw Error(ErrorCode::argument, "q[" + std::to_string(i) + "] is not finite");
          updateGeometryPlacements(model, s.data, b.geometry, s.geometry, VectorArg(state, q.rows));
          b.flags[static_cast<std::size_t>(k)] = anyCollision(b.geometry, s.geometry) ? 1 : 0;
        } catch (const Error& e) {
          b.flags[static_cast<std::size_t>(k)] = 1;
          if (s.failed < 0) {
            s.failed = k;
            s.error = e.what();
          }
        }
      }
    }
  });
  const GeometryBatchImpl::Scratch* first = nullptr;
  for (const auto& s : b.scratch)
    if (s.failed >= 0 && (first == nullptr || s.failed < first->failed)) first = &s;
  if (first != nullptr) throw Error(ErrorCode::argument, "computeCollisions: state " + std::to_string(first->failed) + ": " + first->error);
  return b.flags.data();
}

}  // namespace detail

}  // namespace dyn
