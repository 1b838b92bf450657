// SPDX-License-Identifier: BSD-2-Clause
// Everything takes a state in each lane but the equations of rows that depend on each other.
#include "algorithm/support/batch_support.hpp"
#include "constraint/delassus_solver.hpp"
#include "constraint/rows.hpp"
#include "constraint/solution.hpp"
#include "data/room.hpp"
#include "kernels/isa/constraint_table.hpp"

#include <dyn/constraint/batch.hpp>

#include <cmath>

namespace dyn {

struct BatchConstraintImpl {
  /// The dense equations of one state's rows. Vectors have room for a pack.
  struct Equations {
    kernels::ConstraintWorkspace workspace;  ///< only the Delassus matrix and its inverse
    DelassusSolver solver;
    double *wanted = nullptr, *solution = nullptr;

    void layOut(int rows, Arena& arena) {
      kernels::layOutDelassus(workspace, rows, arena);
      solver.layOut(rows, arena);
      for (double** vector : {&wanted, &solution}) arena.take(*vector, static_cast<std::size_t>(rows + most_lanes));
    }
  };
  /// The memory of one thread, for a block.
  struct Thread {
    PackMemory states;  ///< of the kernels
    kernels::RowsOfStates rows{};
    std::vector<Equations> equations;  ///< by lane
    PackMemory dense;                  ///< of the equations
    std::vector<double> targets;       ///< what the response of the degrees of freedom must give to each row and lane
    std::vector<double> change;        ///< of the velocities, nv numbers a lane
  };

  explicit BatchConstraintImpl(const ConstraintSet& s) : set(s) {}
  ConstraintSet set;
  int capacity = 0;
  std::vector<Thread> threads;
  std::vector<double> motion, forces, residual;  ///< nv, rows and one number per state
  std::vector<int> rank, iterations;
};

BatchConstraintData::BatchConstraintData(const ConstraintSet& set, const BatchData& batch) : impl_(std::make_unique<BatchConstraintImpl>(set)) {
  const BatchImpl<double>& d = batch.impl();
  const CompactImpl& m = *d.model;
  const PackedConstraints& c = set.impl();
  checkSet("BatchConstraintData", m, set);
  refuseDependentJoints("BatchConstraintData", m);
  const kernels::ConstraintStateKernels& k = kernels::constraintKernels().states;
  BatchConstraintImpl& x = *impl_;
  const auto lanes = static_cast<std::size_t>(d.kernels->lanes), rows = static_cast<std::size_t>(c.rows),
             states = static_cast<std::size_t>(d.capacity);
  const auto layOutAll = [&](std::vector<BatchConstraintImpl::Equations>& equations, char* base) {
    Arena arena(base);
    for (BatchConstraintImpl::Equations& e : equations) e.layOut(c.rows, arena);
    return arena.used();
  };
  std::vector<BatchConstraintImpl::Equations> counted(lanes);
  const std::size_t dense = layOutAll(counted, nullptr), recursions = k.bytes(m, c);
  checkRoom("BatchConstraintData of " + std::to_string(d.capacity) + " states and " + std::to_string(c.rows) + " rows",
            static_cast<double>(states) * (sizeof(double) * (static_cast<double>(m.nv) + c.rows + 1) + 2 * sizeof(int)) +
                static_cast<double>(d.workers->count()) * static_cast<double>(dense + recursions));
  x.capacity = d.capacity;
  x.threads.resize(static_cast<std::size_t>(d.workers->count()));
  for (BatchConstraintImpl::Thread& t : x.threads) {
    t.states = PackMemory(recursions);
    t.rows = k.prepare(m, c, t.states.data());
    t.equations.resize(lanes);
    t.targets.resize(rows * lanes);
    t.change.resize(static_cast<std::size_t>(m.nv) * lanes);
    t.dense = PackMemory(dense);
    layOutAll(t.equations, t.dense.data());
  }
  x.motion.resize(static_cast<std::size_t>(m.nv) * states);
  x.forces.resize(rows * states);
  x.residual.resize(states);
  x.rank.resize(states);
  x.iterations.resize(states);
}

BatchConstraintData::~BatchConstraintData() = default;
BatchConstraintData::BatchConstraintData(BatchConstraintData&&) noexcept = default;
BatchConstraintData& BatchConstraintData::operator=(BatchConstraintData&&) noexcept = default;

const ConstraintSet& BatchConstraintData::set() const { return impl_->set; }
std::size_t BatchConstraintData::bytes() const {
  const BatchConstraintImpl& x = *impl_;
  std::size_t sum = sizeof x + sizeof(double) * (x.motion.size() + x.forces.size() + x.residual.size()) + 2 * sizeof(int) * x.rank.size();
  for (const BatchConstraintImpl::Thread& t : x.threads)
    sum += t.states.bytes() + t.dense.bytes() + sizeof(double) * (t.targets.size() + t.change.size()) +
           t.equations.size() * sizeof(BatchConstraintImpl::Equations);
  return sum;
}

namespace detail {

namespace {

using ConstraintThread = BatchConstraintImpl::Thread;
using RowEquations = BatchConstraintImpl::Equations;

/// The arguments of a call. Impacts have no tau.
struct ConstrainedCall {
  const char* name;
  StatesView<double> q, v, tau;
  bool impact;
  double restitution;
};

/// The states of a block: `count` of them, from `first` on.
struct ConstrainedBlock {
  const ConstrainedCall& call;
  const CompactImpl& m;
  char* scratch;  ///< of the batch's thread
  int first, count, lanes;
  kernels::Block<double> block;
};

/// The part of locateRows for rows on joints. Lanes without a state stay as they are, since nobody reads them.
void locateJointRowsOfStates(const ConstrainedBlock& b, const PackedConstraints& c, const kernels::RowsOfStates& rows) {
  if (!c.actsOnJoints()) return;
  for (int l = 0; l < b.count; ++l) {
    const std::ptrdiff_t state = b.first + l;
    const StatesView<double>&q = b.call.q, &v = b.call.v;
    const kernels::RowMotion& x = rows.motion;
    locateJointRows(b.m, c, q.data + state * q.stride, v.data + state * v.stride, {x.bias + l, x.drift + l, x.fall + l, x.velocity + l, x.error + l},
                    rows.projection + l, rows.room, b.lanes);
  }
}

/// Factors the Delassus matrix of the state in lane l.
void factorState(const PackedConstraints& c, const kernels::RowsOfStates& rows, int l, int lanes, const ConstraintSettings& settings,
                 RowEquations& e) {
  for (std::ptrdiff_t r = 0; r < c.rows; ++r) {
    e.workspace.bound[r] = rows.bound[lanes * r + l];
    const double* from = rows.delassus + lanes * rows.stride * r + l;
    double* to = e.workspace.delassus + e.workspace.stride * r;
    for (std::ptrdiff_t k = 0; k < c.rows; ++k) to[k] = from[lanes * k];
  }
  e.solver.factor(e.workspace, settings);
}

/// Solves for the forces of the state in lane l. Returns the number of iterations.
int solveState(const PackedConstraints& c, const kernels::RowsOfStates& rows, int l, int lanes, RowEquations& e) {
  for (std::ptrdiff_t r = 0; r < c.rows; ++r) e.wanted[r] = rows.wanted[lanes * r + l];
  const int iterations = e.solver.solve(e.wanted, e.solution);
  for (std::ptrdiff_t r = 0; r < c.rows; ++r) rows.forces[lanes * r + l] = e.solution[r];
  return iterations;
}

/// Solves for the forces of the rows and corrects them once, as constraintDynamics does for one state. The sweep is done. States whose rows depend on
/// each other are solved one by one, and all states if mu > 0, because they differ in iterations.
void solveBlock(ConstrainedBlock& b, ConstraintThread& t, const ConstraintSettings& settings, BatchConstraintImpl& x) {
  const PackedConstraints& c = x.set.impl();
  const kernels::ConstraintStateKernels& k = kernels::constraintKernels().states;
  const kernels::RowsOfStates& rows = t.rows;
  char* const memory = t.states.data();
  const bool alone = settings.mu > 0;
  const auto want = [&] {
    for (std::size_t i = 0; i < t.targets.size(); ++i) rows.wanted[i] = t.targets[i] - rows.gamma[i];
  };
  // Calls use(state, lane, equations) for the states that are solved one by one.
  const auto eachAlone = [&](auto&& use) {
    for (int l = 0; l < b.count; ++l)
      if (alone || rows.irregular[l] != 0) use(static_cast<std::size_t>(b.first + l), l, t.equations[static_cast<std::size_t>(l)]);
  };
  const auto takeForces = [&](bool add) {
    double* to = x.forces.data() + static_cast<std::ptrdiff_t>(c.rows) * b.first;
    for (int l = 0; l < b.count; ++l)
      for (std::ptrdiff_t r = 0; r < c.rows; ++r, ++to) *to = rows.forces[b.lanes * r + l] + (add ? *to : 0.0);
  };
  for (std::size_t i = 0; i < t.targets.size(); ++i)
    t.targets[i] =
        -(b.call.impact ? (1 + b.call.restitution) * rows.motion.velocity[i] : rows.carried[i] + rows.motion.fall[i] + rows.motion.drift[i]);
  want();
  if (!alone) {
    k.invert(c, settings.rank_tolerance, memory);
    k.solve(c, memory);
    std::fill_n(x.rank.begin() + b.first, b.count, c.rows);
    std::fill_n(x.iterations.begin() + b.first, b.count, c.rows > 0 ? 1 : 0);
  }
  eachAlone([&](std::size_t state, int l, RowEquations& e) {
    factorState(c, rows, l, b.lanes, settings, e);
    x.iterations[state] = solveState(c, rows, l, b.lanes, e);
    x.rank[state] = e.solver.rank();
  });
  takeForces(false);
  k.respondToRows(c, memory);
  k.rowsOfResponse(c, memory);
  want();
  for (int l = 0; l < b.count; ++l) {
    double& largest = x.residual[static_cast<std::size_t>(b.first + l)] = 0;
    for (std::ptrdiff_t r = 0; r < c.rows; ++r)
      if (const double lacking = std::abs(rows.wanted[b.lanes * r + l]); !(lacking <= largest)) largest = lacking;
  }
  if (!alone) k.solve(c, memory);
  eachAlone([&](std::size_t, int l, RowEquations& e) { solveState(c, rows, l, b.lanes, e); });
  takeForces(true);
  k.respondToRows(c, memory);
  k.accelerate(b.m, b.scratch, c, b.call.impact ? Vec3<double>{} : b.m.gravity, b.block, memory);
}

BatchConstrainedViews runConstrained(const ConstrainedCall& call, const CompactModel& model, BatchData& data, BatchConstraintData& constraints) {
  const char* const name = call.name;
  const StatesView<double>&q = call.q, &v = call.v, &tau = call.tau;
  BatchImpl<double>& d = data.impl();
  BatchConstraintImpl& x = constraints.impl();
  const PackedConstraints& c = x.set.impl();
  const CompactImpl& m = model.impl();
  checkBatch(name, model, d, q, Need::state, "state");
  checkStates(name, "v", v, m.nv, q.cols);
  if (!call.impact) checkStates(name, "tau", tau, m.nv, q.cols);
  checkSet(name, m, x.set);
  if (q.cols > x.capacity || d.workers->count() > static_cast<int>(x.threads.size()))
    throw Error(ErrorCode::argument, std::string(name) + ": the constraints' data was made for a batch of fewer states or threads");
  const kernels::ConstraintStateKernels& k = kernels::constraintKernels().states;
  const kernels::RowRates rates = call.impact || c.drift_with_velocity ? kernels::RowRates::velocities : kernels::RowRates::drift;
  const StatesOut<double> results[] = {{x.motion.data(), m.nv}, {x.forces.data(), c.rows}, {x.residual.data(), 1}};
  const int lanes = d.kernels->lanes;
  const Failure failure = forBlocks(d, static_cast<int>(q.cols), lanes, [&](int thread, int first, int count, Failure& f) {
    ConstraintThread& t = x.threads[static_cast<std::size_t>(thread)];
    kernels::Block<double> block;
    const CompactImpl& own = chooseModels(d, first, block);
    readStates<double>(d, thread, {q, call.impact ? tau : v, tau, true}, first, count, block);
    ConstrainedBlock b{call, own, d.scratch[static_cast<std::size_t>(thread)].data(), first, count, lanes, block};
    double* const motion = x.motion.data() + static_cast<std::ptrdiff_t>(m.nv) * first;
    b.block.results[0] = call.impact ? t.change.data() : motion;
    k.articulate(own, b.scratch, c, columns(v, first, count), rates, b.block, t.states.data());
    locateJointRowsOfStates(b, c, t.rows);
    k.sweep(own, c, t.states.data());
    solveBlock(b, t, constraints.settings, x);
    for (std::ptrdiff_t l = 0; l < count && call.impact; ++l)
      for (std::ptrdiff_t i = 0; i < m.nv; ++i)
        motion[m.nv * l + i] = v.data[(first + l) * v.stride + i] + t.change[static_cast<std::size_t>(m.nv * l + i)];
    for (int l = 0; l < count; ++l) b.block.not_finite = b.block.not_finite || b.block.failed[l] != 0;
    noteFailures(q, b.block, results, first, count, f);
  });
  fail(name, m, failure, q);
  return {x.motion.data(), x.forces.data(), x.residual.data(), x.rank.data(), x.iterations.data()};
}

}  // namespace

BatchConstrainedViews batchConstraintDynamics(const CompactModel& model, BatchData& data, StatesView<double> q, StatesView<double> v,
                                              StatesView<double> tau, BatchConstraintData& constraints) {
  return runConstrained({"constraintDynamics", q, v, tau, false, 0}, model, data, constraints);
}

BatchConstrainedViews batchImpulseDynamics(const CompactModel& model, BatchData& data, StatesView<double> q, StatesView<double> v, double restitution,
                                           BatchConstraintData& constraints) {
  checkRestitution(restitution);
  return runConstrained({"impulseDynamics", q, v, {}, true, restitution}, model, data, constraints);
}

}  // namespace detail

}  // namespace dyn
