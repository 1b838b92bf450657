// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/solution.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/external.hpp"
#include "at.hpp"
#include "constraint/kkt.hpp"
#include "number_text.hpp"

#include <dyn/algorithm/rnea.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <string>

namespace dyn {

void checkConstraints(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints) {
  checkData(algorithm, model, data);
  checkSet(algorithm, model.impl(), constraints.set());
}

void checkSet(const char* algorithm, const CompactImpl& m, const ConstraintSet& set) {
  if (&set.model().impl() != &m)
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the constraints were looked up in another model; make a ConstraintSet of this one");
}

void checkRestitution(double restitution) {
  if (!(restitution >= 0 && restitution <= 1))
    throw Error(ErrorCode::argument, "impulseDynamics: restitution is " + number(restitution) + ", it must be between 0 and 1");
}

PlacedBodies placedBodies(DataImpl& d, const ConstraintDataImpl& c) {
  const kernels::ConstraintKernels& k = kernels::constraintKernels();
  if (c.in_lane_groups) return {k.lane_groups, d.packed[true].data()};
  return {k.single, static_cast<Workspace<double>*>(&d)};
}

void articulateBodies(const char* algorithm, const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v,
                      const double* tau, const Force<double>* external) {
  c.in_lane_groups = kernels::useLaneGroups(m) && external == nullptr;
  if (c.in_lane_groups) {
    const kernels::PackedKernels& k = kernels::active().lane_groups;
    int failed = 0;
    if (!k.articulate(m, d.packed[true].data(), q, v, tau, failed)) checkConfiguration("q", m, q);
    checkFactors(algorithm, m, failed, q);
  } else {
    evaluateJoints(m, d, q, v);
    kernels::active().single.articulate(m, d, v, tau, external);
    checkFactors(algorithm, m, d.failed[0], q);
  }
}

void actOnBodies(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* forces) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  kernels::constraintKernels().respondToRows(packed, forces, c.workspace);
  bodies.run.takeResponse(m, bodies.memory, packed, c.workspace);
}

void accelerateBodies(const CompactImpl& m, DataImpl& d, const ConstraintDataImpl& c, const Vec3<double>& gravity, double* ddq) {
  if (c.in_lane_groups) {
    kernels::active().lane_groups.accelerate(m, d.packed[true].data(), gravity, ddq);
  } else {
    kernels::active().single.accelerate(m, d, gravity, ddq);
  }
}

void prepareRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v, bool velocity) {
  using enum kernels::RowRates;
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  const kernels::RowRates rates = v == nullptr ? none : velocity || packed.drift_with_velocity ? velocities : drift;
  bodies.run.locate(m, bodies.memory, packed, v, rates, c.workspace);
  locateRows(m, packed, q, v, rates, c.frames, c.motion, c.workspace);
}

void articulateRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  bodies.run.sweep(m, bodies.memory, packed, true, c.workspace);
  kernels::constraintKernels().delassusMatrix(packed, c.workspace);
}

namespace {
/// After placeOutward and prepareRows: c.J and c.gamma.
void rigidRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  bodies.run.sweep(m, bodies.memory, packed, false, c.workspace);
  const std::ptrdiff_t rows = packed.rows;
  std::fill_n(c.J, rows * m.nvx, 0.0);
  for (std::size_t k = 0; k < packed.dofs.size(); ++k) std::copy_n(c.workspace.projectionOf(static_cast<int>(k)), rows, c.J + rows * packed.dofs[k]);
  std::copy_n(c.workspace.carried, rows, c.gamma);
  if (m.couplings.empty()) return;
  // A dependent joint accelerates even if its master does not.
  for (std::size_t k = 0; k < m.couplings.size(); ++k) {
    const std::ptrdiff_t s = m.index[at(m.couplings[k].body)].idx_v;
    for (std::ptrdiff_t r = 0; r < rows; ++r) c.gamma[r] += d.ax[s] * c.J[rows * s + r];
  }
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.fold(rows, c.J);
  dependents.keep(rows, c.J, c.J);
}
}  // namespace

void placeRows(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  kernels::active().single.placeOutward(m, d, in.v);
  c.in_lane_groups = false;
  prepareRows(m, d, c, in.q, v ? in.v : nullptr);
  rigidRows(m, d, c);
}

void freeMotion(const char* algorithm, const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                std::size_t count, bool by_inertia, ConstraintDataImpl& c, bool velocity) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  c.by_inertia = by_inertia || !m.couplings.empty();
  if (c.by_inertia) {
    const double* bias = detail::rnea(model, data, q, v, {d.zero, m.nv}, fext, count);
    for (int k = 0; k < m.nv; ++k) d.ddq[k] = tau.data[k] - bias[k];
    projectInertia(algorithm, model, data, q, &v, c);
    solveInertia(model, data, d.ddq);
    addRowsOf(m, c, d.ddq, c.gamma);
    wantedAccelerations(c, c.gamma);
  } else {
    const Inputs in = readInputs(algorithm, model, data, q, &v, nullptr);
    articulateBodies(algorithm, m, d, c, in.q, in.v, lessDissipation(m, d, tau.data, in.v), readExternalForces(algorithm, m, d, fext, count));
    prepareRows(m, d, c, in.q, in.v, velocity);
    articulateRows(m, d, c);
    const PackedConstraints& packed = c.set.impl();
    kernels::constraintKernels().rowsOfResponse(packed, c.workspace, c.gamma);
    for (int r = 0; r < packed.rows; ++r) c.wanted[r] = wantedOfResponse(c, r) - c.gamma[r];
  }
}

void wantedAccelerations(ConstraintDataImpl& c, const double* free) {
  for (int r = 0; r < c.set.rows(); ++r) c.wanted[r] = -(free[r] + c.motion.drift[r]);
}

}  // namespace dyn
