// SPDX-License-Identifier: BSD-2-Clause
#include "compile/draft.hpp"
#include "data/batch_impl.hpp"
#include "data/room.hpp"
#include "kernels/derivative/tree_factors.hpp"
#include "same_bits.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <string>
#include <utility>

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
  const std::size_t kept = has(needs, Need::derivatives) && !coupled ? kernels::keptNumbers(m) : 0;
  checkRoom("BatchData of " + std::to_string(capacity) + " states of a model with " + std::to_string(m.nv) + " degrees of freedom",
            sizeof(T) * states * (wide * (4 + matrices + (has(needs, Need::jacobians) ? 6 : 0)) + static_cast<double>(kept) + 11) +
                threads * static_cast<double>(d.kernels->bytes(m, room)));
  for (int i = 0; i < threads; ++i) {
    d.scratch.emplace_back(d.kernels->bytes(m, room));
    d.kernels->prepare(m, room, d.scratch.back().data());
    if (coupled) d.expanded.emplace_back(m, d.kernels->lanes);
  }
  const auto n = static_cast<std::size_t>(capacity), nv = static_cast<std::size_t>(m.nv);
  for (std::vector<T>* result : {&d.tau, &d.nle, &d.gravity, &d.ddq}) result->assign(nv * n, T(0));
  for (std::vector<T>& vector : d.com) vector.assign(3 * n, T(0));
  for (std::vector<T>& energy : d.energies) energy.assign(n, T(0));
  d.factors = PackMemory(kept * sizeof(T) * static_cast<std::size_t>(d.blocks() * d.kernels->lanes));
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

namespace {

/// Throws Error(argument) unless `model` differs from `own` in inertias only.
void checkSameNumbers(const CompactImpl& own, const CompactImpl& model, std::size_t place) {
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::argument, "setModels: model " + std::to_string(place) + " " + why); };
  const auto equal = []<class N>(const SharedVector<N>& a, const SharedVector<N>& b) {
    return a.data() == b.data() || std::equal(a.data(), a.data() + a.size(), b.data(), sameBits<N>);
  };
  if (model.batches.data() != own.batches.data() || model.constants.size() != own.constants.size())
    refuse("does not come from the batch's own model; make it by withNumbers() of that one");
  if (!equal(own.described.placements, model.described.placements))
    refuse("has other placements of joints than the batch's own; only inertias may differ");
  if (!sameBits(own.gravity, model.gravity)) refuse("has another gravity than the batch's own; only inertias may differ");
  if (own.damping != model.damping || own.friction != model.friction || own.armature != model.armature)
    refuse("has other damping, friction or armature than the batch's own; only inertias may differ");
}

/// The numbers of body i of `model` in the frame that the body has in `own`. The origin of a joint may be elsewhere on its axis in each model.
InertiaConstants<double> inertiaIn(const CompactImpl& own, const CompactImpl& model, std::size_t i) {
  const BodyConstants<double>& c = model.constants[i];
  const auto joint = static_cast<std::size_t>(own.index[i].joint);
  const SE3<double>&to = own.user_frame[joint], &from = model.user_frame[joint];
  if (sameBits(to, from)) return {c.mass, c.com, c.rotational, c.h, c.origin};
  const SE3<long double> moved = cast<long double>(to) * cast<long double>(from).inverse();
  return inertiaConstants(cast<long double>(Inertia<double>{c.mass, c.com, c.rotational}).transformed(moved));
}

}  // namespace

template <class T>
void BasicBatchData<T>::setModels(std::span<const CompactModel> models) {
  BatchImpl<T>& d = *impl_;
  const CompactImpl& own = *d.model;
  if (models.size() > static_cast<std::size_t>(d.capacity))
    throw Error(ErrorCode::size, "setModels: there are " + std::to_string(models.size()) + " models, and the batch has room for " +
                                     std::to_string(d.capacity) + " states");
  for (std::size_t k = 0; k < models.size(); ++k) checkSameNumbers(own, models[k].impl(), k);
  constexpr std::size_t numbers = sizeof(InertiaConstants<T>) / sizeof(T);
  const std::size_t bodies = own.constants.size(), lanes = static_cast<std::size_t>(d.kernels->lanes);
  const std::size_t states = (models.size() + lanes - 1) / lanes * lanes;
  PackMemory inertias;
  std::vector<std::shared_ptr<const CompactImpl>> by_state;
  if (lanes > 1) {
    checkRoom("setModels for " + std::to_string(states) + " states", static_cast<double>(states * bodies * numbers * sizeof(T)));
    inertias = PackMemory(states * bodies * numbers * sizeof(T));
  }
  for (std::size_t k = 0; k < (lanes > 1 ? states : models.size()); ++k) {
    // States that only fill up the last block are of the last model.
    const CompactImpl& model = models[std::min(k, models.size() - 1)].impl();
    const auto in_frames = lanes > 1 ? nullptr : std::make_shared<CompactImpl>(own);
    for (std::size_t i = 1; i < bodies; ++i) {
      const InertiaConstants<double> x = inertiaIn(own, model, i);
      if (in_frames) {
        BodyConstants<double>& c = in_frames->constants[i];
        c = {c.placement, x.mass, x.com, x.rotational, x.h, x.origin};
        in_frames->constants_float[i] = broadcast<float>(c);
        continue;
      }
      const auto* from = reinterpret_cast<const double*>(&x);
      T* const to = reinterpret_cast<T*>(inertias.data()) + (k / lanes * bodies + i) * numbers * lanes + k % lanes;
      for (std::size_t n = 0; n < numbers; ++n) to[n * lanes] = static_cast<T>(from[n]);
    }
    if (in_frames) by_state.push_back(in_frames);
  }
  d.inertias = std::move(inertias);
  d.by_state = std::move(by_state);
  d.models = static_cast<int>(models.size());
  d.massless = std::any_of(models.begin(), models.end(), [](const CompactModel& model) { return !(model.mass() > 0); });
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
  std::size_t sum =
      sizeof d + d.poses.bytes() + d.velocities.bytes() + d.accelerations.bytes() + d.inertias.bytes() + d.factors.bytes() +
      d.by_state.size() * (sizeof(CompactImpl) + d.model->constants.size() * (sizeof(BodyConstants<double>) + sizeof(BodyConstants<float>)));
  for (const PackMemory& memory : d.scratch) sum += memory.bytes();
  for (const ExpandedStates<T>& states : d.expanded) sum += states.bytes();
  for (const std::vector<T>& map : d.maps) sum += sizeof(T) * map.size();
  for (const std::vector<T>& vector : d.com) sum += sizeof(T) * vector.size();
  for (const std::vector<T>& energy : d.energies) sum += sizeof(T) * energy.size();
  for (const StateMatrices<T>* matrices : {&d.M, &d.by_q, &d.by_v, &d.by_a}) sum += matrices->bytes();
  return sum + sizeof(T) * (d.tau.size() + d.nle.size() + d.gravity.size() + d.ddq.size() + d.J.size());
}

template class BasicBatchData<double>;
template class BasicBatchData<float>;

}  // namespace dyn
