// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/traced_bodies.hpp"

namespace dyn {

namespace {
constexpr std::size_t numbers_in_constants = sizeof(BodyConstants<double>) / sizeof(double);
const double* numbersOf(const BodyConstants<double>& c) { return reinterpret_cast<const double*>(&c); }

/// Gives each body a lane group of its own.
LaneGroupPlan assignAlone(const CompactImpl& m) {
  LaneGroupPlan plan;
  plan.lane_groups.resize(static_cast<std::size_t>(m.bodies()));
  plan.lane_slots.resize(plan.lane_groups.size());
  for (int i = 0; i < m.bodies(); ++i) {
    LaneGroup& group = plan.lane_groups[static_cast<std::size_t>(i)];
    std::fill(group.body, group.body + group_lanes, -1);
    group.body[0] = i;
    plan.lane_slots[static_cast<std::size_t>(i)] = {i, 0, 1, m.index[static_cast<std::size_t>(i)].idx_v};
  }
  return plan;
}
}  // namespace

Limbs::Limbs(const CompactImpl& model, bool side_by_side)
    : m(model),
      packable(side_by_side),
      plan(packable ? assignLanes(m) : assignAlone(m)),
      runs(static_cast<std::size_t>(m.bodies())),
      gives_first(runs.size(), 0) {
  for (const Run& run : m.runs)
    for (int k = 0; k < run.count; ++k)
      runs[static_cast<std::size_t>(run.first + k)] = {run.shape, run.nv, run.first + k, 1, run.batch, run.slot + k};
  std::vector<char> has_given(runs.size(), 0);
  uniform.resize(plan.lane_groups.size());
  for (std::size_t s = plan.lane_groups.size(); s-- > 1;) {
    std::vector<char>& same = uniform[s];
    same.assign(numbers_in_constants, 1);
    const double* first = nullptr;
    for (const int body : plan.lane_groups[s].body) {
      if (body < 0) continue;
      const auto parent = static_cast<std::size_t>(m.index[static_cast<std::size_t>(body)].parent);
      gives_first[static_cast<std::size_t>(body)] = !has_given[parent];
      has_given[parent] = 1;
      const double* numbers = numbersOf(m.constants[static_cast<std::size_t>(body)]);
      if (first == nullptr) first = numbers;
      // Products with 0, 1 and -1 are left out, and a negative factor moves its sign.
      for (std::size_t k = 0; k < numbers_in_constants; ++k) {
        const auto plain = [](double x) { return x == 0 ? 0 : x == 1 ? 1 : x == -1 ? 2 : x < 0 ? 3 : 4; };
        if (plain(numbers[k]) != plain(first[k])) same[k] = 0;
      }
    }
  }
}

namespace kernels {

BodyConstants<Traced> TracedBodies::constants(int i) const {
  BodyConstants<Traced> out = Bodies::constants(i);
  const LaneSlot& lane_slot = limbs.laneSlot(i);
  if (!limbs.several(lane_slot.group)) return out;
  auto* numbers = reinterpret_cast<Traced*>(&out);
  const std::vector<char>& uniform = limbs.uniform[static_cast<std::size_t>(lane_slot.group)];
  for (std::size_t k = 0; k < numbers_in_constants; ++k)
    if (!uniform[k]) numbers[k] = limbs.builder->opaque(numbers[k].value);
  return out;
}

}  // namespace kernels
}  // namespace dyn
