// SPDX-License-Identifier: BSD-2-Clause
#include "data/data_impl.hpp"
#include "data/room.hpp"
#include "kernels/isa/table.hpp"

#include <algorithm>
#include <cstring>

namespace dyn {

namespace {

void layOutAll(DataImpl& d, const CompactImpl& m, Arena& arena) {
  const auto n = static_cast<std::size_t>(m.bodies());
  const auto nqx = static_cast<std::size_t>(m.nqx), nvx = static_cast<std::size_t>(m.nvx), nv = static_cast<std::size_t>(m.nv);
  layOut<double>(d, m, arena);
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    if (batch.shape != Shape::dense) continue;
    const auto count = static_cast<std::size_t>(batch.count);
    arena.take(d.dual[b].q, static_cast<std::size_t>(batch.nq) * count);
    arena.take(d.dual[b].pose, 12 * count);
    arena.take(d.dual[b].subspace, static_cast<std::size_t>(6 * batch.nv) * count);
  }
  arena.take(d.fext, n);
  if (!m.couplings.empty()) {
    arena.take(d.qx, nqx);
    arena.take(d.vx, nvx);
    arena.take(d.ax, nvx);
    arena.take(d.taux, nvx);
    arena.take(d.G, m.couplings.size());
    arena.take(d.dG, m.couplings.size());
    arena.take(d.ddG, m.couplings.size());
  }
  arena.take(d.tau, nv);
  arena.take(d.nle, nv);
  arena.take(d.g, nv);
  arena.take(d.ddq, nvx);
  arena.take(d.Jcom, 3 * nvx);
  arena.take(d.J, 6 * nvx);
  arena.take(d.columns, 12 * nvx);
  if (has(d.needs, Need::derivatives)) {
    layOut(d.derivatives, m, arena);
    arena.take(d.dtau_dq, nvx * nvx);
    arena.take(d.dtau_dv, nvx * nvx);
    arena.take(d.ddq_dq, nvx * nvx + most_lanes);
    arena.take(d.ddq_dv, nvx * nvx + most_lanes);
    arena.take(d.Minv, nvx * nvx + most_lanes);
    arena.take(d.C, nvx * nvx);
    const std::size_t parameters = 10 * (m.joints.size() - 1);
    layOut(d.torque_regressor, m, arena);
    arena.take(d.expanded_regressor, nvx * parameters + most_lanes);
    d.regressor = d.expanded_regressor;
    if (!m.couplings.empty()) arena.take(d.regressor, nv * parameters);
    arena.take(d.energy_regressor, parameters);
    arena.take(d.kinematics_v, nvx);
    arena.take(d.kinematics_a, nvx);
    arena.take(d.column, nvx + most_lanes);
    for (double** map : {&d.Ag, &d.dAg, &d.dh_dq, &d.dhdot_dq, &d.dhdot_dv}) arena.take(*map, 6 * nvx);
    if (!m.couplings.empty())
      for (double*& x : d.expanded) arena.take(x, nvx * nvx);
  }
  if (has(d.needs, Need::mass_matrix)) {
    arena.take(d.M, nv * nv + most_lanes);
    if (!m.couplings.empty()) arena.take(d.Mx, nvx * nvx);
  }
}

void layOutCopies(DataImpl& d, const CompactImpl& m, Arena& arena) {
  arena.take(d.zero, static_cast<std::size_t>(std::max(m.nvx, 1)));
  arena.take(d.copied_q, static_cast<std::size_t>(m.nq));
  for (double** place : {&d.copied_v, &d.copied_a, &d.copied_tau}) arena.take(*place, static_cast<std::size_t>(m.nv));
}

/// Makes memory of zeros for the arrays that layOut(arena) takes, and lays them out. Throws Error(memory) if it does not fit into this machine.
template <class LayOut>
PackMemory memoryFor(const CompactImpl& m, const LayOut& layOut) {
  Arena count(nullptr);
  layOut(count);
  checkRoom("Data of a model with " + std::to_string(m.nv) + " degrees of freedom", static_cast<double>(count.used()));
  PackMemory memory(count.used());
  Arena arena(memory.data());
  layOut(arena);
  return memory;
}

}  // namespace

Data::Data(const CompactModel& model, Need needs) : impl_(std::make_unique<DataImpl>()) {
  kernels::active();  // makes the choice here, where allocation and exceptions are allowed
  const CompactImpl& m = model.impl();
  impl_->model = &m;
  impl_->keep = std::make_shared<CompactModel>(model);
  impl_->needs = has(needs, Need::derivatives) ? needs | Need::mass_matrix : needs;
  impl_->dual.resize(m.batches.size());
  impl_->block = memoryFor(m, [&](Arena& arena) { layOutAll(*impl_, m, arena); });
  impl_->copies = memoryFor(m, [&](Arena& arena) { layOutCopies(*impl_, m, arena); });
  atRest<double>(*impl_);
  const kernels::PackedKernels* packed[2] = {};
  const auto want = [&](bool LaneGroupUses::*algorithm) {
    if (const kernels::PackedKernels* k = kernels::packed(m, algorithm)) packed[k->over_lane_groups] = k;
  };
  want(&LaneGroupUses::rnea);
  want(&LaneGroupUses::aba);
  if (has(impl_->needs, Need::mass_matrix)) want(&LaneGroupUses::mass_matrix);
  if (has(impl_->needs, Need::derivatives)) want(&LaneGroupUses::centroidal_map);
  for (const kernels::PackedKernels* k : packed) {
    if (k == nullptr) continue;
    PackMemory& memory = impl_->packed[k->over_lane_groups];
    memory = PackMemory(k->bytes(m));
    k->prepare(m, memory.data());
  }
  if (has(impl_->needs, Need::derivatives) && kernels::useLaneGroupsForDerivatives(m)) {
    const kernels::SingleKernels& k = kernels::active().single;
    impl_->group_derivatives = PackMemory(k.laneGroupBytes(m));
    k.prepareLaneGroups(m, impl_->group_derivatives.data(), impl_->derivatives);
  }
}

Data::~Data() = default;
Data::Data(Data&&) noexcept = default;
Data& Data::operator=(Data&&) noexcept = default;

std::size_t Data::bytes() const {
  return impl_->block.bytes() + impl_->copies.bytes() + impl_->packed[false].bytes() + impl_->packed[true].bytes() +
         impl_->group_derivatives.bytes() + impl_->dual.size() * sizeof(DualMemory) + sizeof(DataImpl);
}

}  // namespace dyn
