// SPDX-License-Identifier: BSD-2-Clause
#include "data/batch_impl.hpp"
#include "data/room.hpp"

#include <dyn/error.hpp>

#include <string>

namespace dyn {

template <class T>
BasicBatchData<T>::BasicBatchData(const CompactModel& model, int capacity, Need needs, int threads) : impl_(std::make_unique<BatchImpl<T>>()) {
  if (has(needs, Need::derivatives)) needs = needs | Need::mass_matrix;
  if (capacity < 1 || threads < 1)
    throw Error(ErrorCode::argument,
                "BatchData: capacity is " + std::to_string(capacity) + " and threads " + std::to_string(threads) + "; both must be at least 1");
  const CompactImpl& m = model.impl();
  BatchImpl<T>& d = *impl_;
  d.model = &m;
  d.keep = std::make_shared<CompactModel>(model);
  d.needs = needs;
  d.capacity = capacity;
  d.kernels = &blockKernelsOf<T>(kernels::active());
  d.workers = std::make_unique<Workers>(threads);
  d.failures.resize(static_cast<std::size_t>(threads));
  const bool coupled = !m.couplings.empty();  // then forward dynamics factors M
  const kernels::Room room{has(needs, Need::mass_matrix) || coupled, has(needs, Need::jacobians), has(needs, Need::derivatives)};
  const double wide = m.nv, states = capacity;
  const double matrices = has(needs, Need::derivatives) ? 4 * wide + 24 : has(needs, Need::mass_matrix) ? wide : 0;
  checkRoom(
      "BatchData of " + std::to_string(capacity) + " states of a model with " + std::to_string(m.nv) + " degrees of freedom",
      sizeof(T) * states * wide * (4 + matrices + (has(needs, Need::jacobians) ? 6 : 0)) + threads * static_cast<double>(d.kernels->bytes(m, room)));
  for (int i = 0; i < threads; ++i) {
    d.scratch.emplace_back(d.kernels->bytes(m, room));
    d.kernels->prepare(m, room, d.scratch.back().data());
    if (coupled) d.expanded.emplace_back(m, d.kernels->lanes);
  }
  const auto n = static_cast<std::size_t>(capacity), nv = static_cast<std::size_t>(m.nv);
  for (std::vector<T>* result : {&d.tau, &d.nle, &d.gravity, &d.ddq}) result->assign(nv * n, T(0));
  if (has(needs, Need::mass_matrix)) d.M.resize(nv, n);
  if (has(needs, Need::jacobians)) d.J.assign(6 * nv * n, T(0));
  if (has(needs, Need::derivatives)) {
    for (StateMatrices<T>* result : {&d.by_q, &d.by_v, &d.by_a}) result->resize(nv, n);
    for (std::vector<T>& map : d.maps) map.assign(6 * nv * n, T(0));
  }
  if (has(needs, Need::kinematics)) {
    const std::size_t bodies = static_cast<std::size_t>(d.blocks() * d.kernels->lanes) * static_cast<std::size_t>(m.bodies()) * sizeof(T);
    d.poses = PackMemory(12 * bodies);
    d.velocities = PackMemory(6 * bodies);
    d.accelerations = PackMemory(6 * bodies);
  }
}

template <class T>
BasicBatchData<T>::~BasicBatchData() = default;
template <class T>
BasicBatchData<T>::BasicBatchData(BasicBatchData&&) noexcept = default;
template <class T>
BasicBatchData<T>& BasicBatchData<T>::operator=(BasicBatchData&&) noexcept = default;

template <class T>
int BasicBatchData<T>::capacity() const {
  return impl_->capacity;
}
template <class T>
int BasicBatchData<T>::threads() const {
  return impl_->workers->count();
}
template <class T>
int BasicBatchData<T>::lanes() const {
  return impl_->kernels->lanes;
}
template <class T>
std::size_t BasicBatchData<T>::bytes() const {
  const BatchImpl<T>& d = *impl_;
  std::size_t sum = sizeof d + d.poses.bytes() + d.velocities.bytes() + d.accelerations.bytes();
  for (const PackMemory& memory : d.scratch) sum += memory.bytes();
  for (const ExpandedStates<T>& states : d.expanded) sum += states.bytes();
  for (const std::vector<T>& map : d.maps) sum += sizeof(T) * map.size();
  for (const StateMatrices<T>* matrices : {&d.M, &d.by_q, &d.by_v, &d.by_a}) sum += matrices->bytes();
  return sum + sizeof(T) * (d.tau.size() + d.nle.size() + d.gravity.size() + d.ddq.size() + d.J.size());
}

template class BasicBatchData<double>;
template class BasicBatchData<float>;

}  // namespace dyn
