// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/constraint_data.hpp"

#include <dyn/constraint/constraint_set.hpp>
#include <dyn/error.hpp>

#include <algorithm>

namespace dyn {

ConstraintSet::ConstraintSet(const CompactModel& model) : model_(model), impl_(model.impl().constraints) {}

ConstraintSet::ConstraintSet(const CompactModel& model, const std::vector<ConstraintDescription>& constraints, const JointRegistry* registry)
    : model_(model), impl_(std::make_shared<PackedConstraints>(packConstraints(model, constraints, registry))) {}

ConstraintSet::ConstraintSet(const ConstraintSet& base, const std::vector<ConstraintDescription>& more, const JointRegistry* registry)
    : model_(base.model_), impl_(std::make_shared<PackedConstraints>(packConstraints(base.model_, more, registry, base.impl_.get()))) {}

namespace {
std::size_t checked(int constraint, int count) {
  if (constraint < 0 || constraint >= count)
    throw Error(ErrorCode::argument, "constraint " + std::to_string(constraint) + " does not exist; the set has " + std::to_string(count));
  return static_cast<std::size_t>(constraint);
}
}  // namespace

int ConstraintSet::rows() const { return impl_->rows; }
int ConstraintSet::count() const { return static_cast<int>(impl_->descriptions.size()); }
const ConstraintDescription& ConstraintSet::description(int constraint) const { return impl_->descriptions[checked(constraint, count())]; }
int ConstraintSet::firstRow(int constraint) const { return impl_->first_row[checked(constraint, count())]; }
int ConstraintSet::rows(int constraint) const {
  const std::size_t k = checked(constraint, count());
  return impl_->first_row[k + 1] - impl_->first_row[k];
}

DerivativePattern::DerivativePattern(const ConstraintSet& set) {
  const PackedConstraints& c = set.impl();
  const CompactImpl& m = set.model().impl();
  const auto n = static_cast<std::size_t>(m.nv);
  std::vector<std::size_t> counts;
  // `list` appends the runs of marked numbers to `all` and removes the marks.
  std::vector<char> marked(n);
  const auto list = [&] {
    const std::size_t before = all.size();
    for (std::size_t i = 0; i < n; ++i) {
      if (!marked[i]) continue;
      if (all.size() == before || all.back().end < static_cast<int>(i)) all.push_back({static_cast<int>(i), 0});
      all.back().end = static_cast<int>(i) + 1;
      marked[i] = 0;
    }
    counts.push_back(all.size() - before);
  };
  const auto mark = [&](int begin, int end) { std::fill(marked.begin() + begin, marked.begin() + end, 1); };
  const auto markSlots = [&](const PackedFrameConstraint& f) {
    for (const auto& slot : f.slots)
      if (slot.user >= 0) mark(slot.user, slot.user + 1);
  };
  for (int k = 0; k < m.nv; ++k) {
    if (!m.couplings.empty()) {
      mark(0, m.nv);
    } else {
      kernels::alongPath(m, k, [&](int i) { mark(i, i + 1); });
      mark(k, m.dof_end[static_cast<std::size_t>(k)]);
    }
    for (const PackedFrameConstraint& f : c.frames)
      if (f.forceTurns() && std::any_of(f.slots.begin(), f.slots.end(), [&](const auto& slot) { return slot.user == k; })) markSlots(f);
    list();
  }
  for (const PackedFrameConstraint& f : c.frames) {
    markSlots(f);
    forces_turn = forces_turn || f.forceTurns();
  }
  for (const PackedJointCoupling& k : c.couplings)
    for (const int body : {k.body, k.master})
      mark(m.index[static_cast<std::size_t>(body)].user_v, m.index[static_cast<std::size_t>(body)].user_v + 1);
  for (const PackedJointLock& k : c.locks)
    mark(m.index[static_cast<std::size_t>(k.body)].user_v, m.index[static_cast<std::size_t>(k.body)].user_v + k.rows);
  moves = marked;
  list();
  const kernels::DofRun* next = all.data();
  for (const std::size_t count : counts) {
    forces.push_back({next, static_cast<int>(count)});
    next += count;
  }
  moving = forces.back();
  forces.pop_back();
  twins.assign(n, 0);
  for (std::size_t k = 0; k + 1 < n; ++k) {
    const auto same = [](const kernels::DofRun& a, const kernels::DofRun& b) { return a.begin == b.begin && a.end == b.end; };
    twins[k] = moves[k] == moves[k + 1] && std::equal(forces[k].begin(), forces[k].end(), forces[k + 1].begin(), forces[k + 1].end(), same);
  }
}

namespace {
void layOutAll(ConstraintDataImpl& d, Arena& arena) {
  const PackedConstraints& c = d.set.impl();
  const CompactImpl& m = d.set.model().impl();
  const std::size_t rows = static_cast<std::size_t>(c.rows) + most_lanes, nv = static_cast<std::size_t>(m.nvx);
  arena.take(d.frames, c.frames.size());
  kernels::layOut(d.workspace, c, arena);
  d.solver.layOut(c.rows, arena);
  for (double** vector :
       {&d.motion.bias, &d.motion.drift, &d.motion.fall, &d.motion.velocity, &d.motion.error, &d.lambda, &d.wanted, &d.step, &d.left, &d.gamma})
    arena.take(*vector, rows);
  arena.take(d.J, rows * nv);
  arena.take(d.X, rows * nv);
  arena.take(d.expanded, nv);
  arena.take(d.v_after, nv);
  arena.take(d.q, 2 * static_cast<std::size_t>(m.nqx));
  arena.take(d.matrix, rows * rows);
  arena.take(d.total, c.bodies.size());
  arena.take(d.projections, c.dofs.size());
  arena.take(d.cones, rows);
  d.cone_solver.layOut(c.rows, arena);
  if (!has(d.needs, Need::derivatives)) return;
  std::size_t slots = 0;
  for (const PackedFrameConstraint& f : c.frames) slots = std::max(slots, f.slots.size());
  for (auto& columns : d.columns) arena.take(columns, slots);
  arena.take(d.turning, 12, static_cast<int>(slots));
  for (double** matrix : {&d.row_by_q, &d.row_by_v, &d.lambda_dq, &d.lambda_dv, &d.lambda_dtau}) arena.take(*matrix, rows * nv);
  for (double** matrix : {&d.motion_dq, &d.motion_dv, &d.motion_dtau}) arena.take(*matrix, nv * nv + most_lanes);
  arena.take(d.force, 2 * nv * nv);
  kernels::layOut(d.inverse, d.workspace, c.rows, m.nv, arena);
  arena.take(d.fext, m.joints.size());
  arena.take(d.change, nv + 1);
}
}  // namespace

ConstraintData::ConstraintData(const ConstraintSet& set, Need needs) : impl_(std::make_unique<ConstraintDataImpl>(set, needs)) {
  Arena count(nullptr);
  layOutAll(*impl_, count);
  impl_->block = PackMemory(count.used());  // zeroed
  Arena arena(impl_->block.data());
  layOutAll(*impl_, arena);
  if (has(needs, Need::derivatives)) impl_->pattern.emplace(set);
}

ConstraintData::~ConstraintData() = default;
ConstraintData::ConstraintData(ConstraintData&&) noexcept = default;
ConstraintData& ConstraintData::operator=(ConstraintData&&) noexcept = default;

const ConstraintSet& ConstraintData::set() const { return impl_->set; }
std::size_t ConstraintData::bytes() const { return impl_->block.bytes() + sizeof(ConstraintDataImpl); }

}  // namespace dyn
