#include "constraint/solution.hpp"

#include "algorithm/external.hpp"
#include "constraint/kkt.hpp"

#include <dyn/algorithm/rnea.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <string>

namespace dyn {

namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }
}  // namespace

void checkConstraints(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints) {
  checkData(algorithm, model, data);
  if (&constraints.set().model().impl() != &model.impl())
    throw Error(ErrorCode::argument, std::string(algorithm) + ": the constraints were looked up in another model; make a ConstraintSet of this one");
}

PlacedBodies placedBodies(DataImpl& d, const ConstraintDataImpl& c) {
  const kernels::ConstraintKernels& k = kernels::constraintKernels();
  if (c.in_strips) return {k.strips, d.packed.data()};
  return {k.single, static_cast<Workspace<double>*>(&d)};
}

void articulateBodies(const char* algorithm, const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v,
                      const double* tau, const Force<double>* external) {
  c.in_strips = kernels::useStrips(m) && external == nullptr;
  if (c.in_strips) {
    const kernels::PackedKernels& k = kernels::active().strips;
    int failed = 0;
    if (!k.articulate(m, d.packed.data(), q, v, tau, failed)) checkConfiguration("q", m, q);
    checkFactors(algorithm, m, failed, q);
  } else {
    evaluateJoints(m, d, q, v);
    kernels::active().single.articulate(m, d, v, tau, external);
    checkFactors(algorithm, m, d.failed[0], q);
  }
}

void accelerateBodies(const CompactImpl& m, DataImpl& d, const ConstraintDataImpl& c, const double* forces, const Vec3<double>& gravity,
                      double* ddq) {
  const PlacedBodies bodies = placedBodies(d, c);
  if (forces) bodies.run.addForces(m, bodies.memory, c.set.impl(), c.workspace, forces);
  if (c.in_strips) {
    kernels::active().strips.accelerate(m, d.packed.data(), gravity, ddq);
  } else {
    kernels::active().single.accelerate(m, d, gravity, ddq);
  }
}

void accelerateRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* forces, const Vec3<double>& gravity,
                    double* ddq) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  accelerateBodies(m, d, c, forces, gravity, ddq);
  bodies.run.takeAccelerations(m, bodies.memory, packed, c.workspace);
  rowAccelerations(m, packed, c.frames, q, c.workspace, ddq, c.gamma);
}

void prepareRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  bodies.run.locate(m, bodies.memory, packed, v, c.workspace);
  locateRows(m, packed, q, v, c.frames, c.motion, c.workspace);
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
  for (std::size_t k = 0; k < packed.dofs.size(); ++k) std::copy_n(c.workspace.shareOf(static_cast<int>(k)), rows, c.J + rows * packed.dofs[k]);
  std::copy_n(c.workspace.free, rows, c.gamma);
  if (m.couplings.empty()) return;
  // Followers accelerate by themselves where their masters do not.
  for (std::size_t k = 0; k < m.couplings.size(); ++k) {
    const std::ptrdiff_t s = m.index[at(m.couplings[k].body)].idx_v;
    for (std::ptrdiff_t r = 0; r < rows; ++r) c.gamma[r] += d.ax[s] * c.J[rows * s + r];
  }
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const std::ptrdiff_t s = m.index[at(m.couplings[k].body)].idx_v, t = m.index[at(m.couplings[k].master)].idx_v;
    for (std::ptrdiff_t r = 0; r < rows; ++r) c.J[rows * t + r] += d.G[k] * c.J[rows * s + r];
  }
  for (std::size_t k = 0; k < m.v_of_user.size(); ++k) std::copy_n(c.J + rows * m.v_of_user[k], rows, c.J + rows * static_cast<std::ptrdiff_t>(k));
}
}  // namespace

void placeRows(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  kernels::active().single.placeOutward(m, d, in.v);
  c.in_strips = false;
  prepareRows(m, d, c, in.q, v ? in.v : nullptr);
  rigidRows(m, d, c);
}

void freeMotion(const char* algorithm, const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                std::size_t count, bool by_inertia, ConstraintDataImpl& c) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  c.by_inertia = by_inertia || !m.couplings.empty();
  if (c.by_inertia) {
    const double* bias = detail::rnea(model, data, q, v, {d.zero, m.nv}, fext, count);
    for (int k = 0; k < m.nv; ++k) d.ddq[k] = tau.data[k] - bias[k];
    projectInertia(algorithm, model, data, q, &v, c);
    solveInertia(model, data, d.ddq);
    addRowsOf(m, c, d.ddq, c.gamma);
    wantedAccelerations(c, c.gamma, false);
  } else {
    const Inputs in = readInputs(algorithm, model, data, q, &v, nullptr);
    articulateBodies(algorithm, m, d, c, in.q, in.v, lessLosses(m, d, tau.data, in.v), readExternalForces(algorithm, m, d, fext, count));
    prepareRows(m, d, c, in.q, in.v);
    articulateRows(m, d, c);
    wantedAccelerations(c, c.workspace.free, true);
  }
}

void wantedAccelerations(ConstraintDataImpl& c, const double* free, bool world_falls_up) {
  const int rows = c.set.rows();
  const double *drift = c.motion.drift, *fall = c.motion.fall;
  double* wanted = c.wanted;
  if (world_falls_up) {
    for (int r = 0; r < rows; ++r) wanted[r] = -(free[r] + fall[r] + drift[r]);
  } else {
    for (int r = 0; r < rows; ++r) wanted[r] = -(free[r] + drift[r]);
  }
}

}  // namespace dyn
