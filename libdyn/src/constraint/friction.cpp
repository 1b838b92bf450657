// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/turning.hpp"
#include "constraint/kkt.hpp"
#include "constraint/solution.hpp"

#include <dyn/constraint/friction.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace dyn {

ConstraintDescription frictionContact(const std::string& name, const std::string& frame, const Vec3<double>& point, const Vec3<double>& normal,
                                      const std::string& other) {
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > 0) || !std::isfinite(length)) throw Error(ErrorCode::argument, "contact '" + name + "': its normal has no direction");
  const Vec3<double> z = (1 / length) * normal, least = std::abs(z.x) < 0.6 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0};
  Vec3<double> x = least - dot(least, z) * z;
  x = (1 / std::sqrt(dot(x, x))) * x;
  const Vec3<double> y = cross(z, x);
  ConstraintDescription d = pointContact(frame, other);
  d.name = name;
  auto& c = std::get<FrameConstraint>(d.relation);
  c.placement.p = point;
  c.other_placement.R = {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  c.axes = ConstraintAxes::OTHER;
  return d;
}

namespace detail {

namespace {

/// Reads the cones into c.cones. Throws Error(argument) if a cone does not fit its constraint or a number is out of range.
void readCones(const char* algorithm, ConstraintDataImpl& c, const FrictionCone* cones, std::size_t count, const ContactSettings& settings) {
  const PackedConstraints& packed = c.set.impl();
  const auto refuse = [&](const std::string& why) { throw Error(ErrorCode::argument, std::string(algorithm) + ": " + why); };
  if (!(settings.restitution >= 0 && settings.restitution <= 1)) refuse("restitution must be between 0 and 1");
  const auto refuseContact = [&](int id, const char* why) { refuse("contact '" + c.set.description(id).name + "'" + why); };
  for (std::size_t i = 0; i < count; ++i) {
    const int id = cones[i].constraint;
    if (id < 0 || id >= c.set.count())
      refuse("cone " + std::to_string(i) + " is of constraint " + std::to_string(id) + ", and the set has " + std::to_string(c.set.count()));
    if (!(cones[i].friction >= 0) || !std::isfinite(cones[i].friction)) refuseContact(id, ": its friction is negative or no number");
    if (!std::isfinite(cones[i].gap)) refuseContact(id, ": its gap is no number");
    const int row = packed.first_row[static_cast<std::size_t>(id)] + cones[i].coordinate;
    for (std::size_t k = 0; k < i; ++k)
      if (c.cones[k].row == row) refuseContact(id, " has two cones");
    if (cones[i].both_ways) {
      if (!std::holds_alternative<JointLock>(c.set.description(id).relation))
        refuseContact(id, " is no lock of a joint, whose own friction holds both ways");
      if (cones[i].coordinate < 0 || cones[i].coordinate >= c.set.rows(id))
        refuseContact(id, (" has no degree of freedom " + std::to_string(cones[i].coordinate)).c_str());
      c.cones[i] = {row, cones[i].friction, 0, 1, 1, true};
      continue;
    }
    if (cones[i].coordinate != 0) refuseContact(id, " has a cone of one coordinate, which is for a joint's own friction");
    const auto begins = [row](const auto& x) { return x.row == row; };
    const auto frame = std::find_if(packed.frames.begin(), packed.frames.end(), begins);
    const auto lock = std::find_if(packed.locks.begin(), packed.locks.end(), begins);
    const bool limit = lock != packed.locks.end() && lock->rows == 1;
    if (!limit && (frame == packed.frames.end() || frame->rows != 3 || !frame->turnsFreely()))
      refuseContact(id, " is no point contact, which friction is for, and no lock of a joint of one degree of freedom, which can be a limit");
    if (limit && cones[i].friction > 0) refuseContact(id, " is a limit, which has no friction");
    c.cones[i] = {row, cones[i].friction, cones[i].gap, limit ? 1 : 3, limit && cones[i].downwards ? -1.0 : 1.0};
  }
}

/// Minus the least normal velocity after a step of dt: gap / dt, less the velocity that restitution demands.
double allowance(const PackedCone& cone, double before, double dt, double restitution) {
  if (cone.both_ways) return 0;
  const double bounce = cone.gap <= 0 ? restitution * std::min(0.0, cone.sign * before) : 0.0;
  return cone.sign * (cone.gap / dt + bounce);
}

bool inCone(const PackedCone& cone, const double* all) {
  const double* x = all + cone.row;
  if (cone.both_ways) return std::abs(x[0]) <= cone.friction;
  return cone.rows == 1 ? cone.sign * x[0] >= 0 : std::hypot(x[0], x[1]) <= cone.friction * x[2];
}

/// Tries forces that let no row move, since most contacts stick. They are the solution if all are in their cones. Writes the forces to c.lambda and
/// the remaining velocities to c.gamma. Returns whether this is the solution.
bool holdAll(ConstraintDataImpl& c, const ConstraintSettings& constraints, std::size_t count, double tolerance) {
  const int rows = c.set.rows();
  for (int r = 0; r < rows; ++r) c.step[r] = -c.wanted[r];
  c.solver.factor(c.workspace, constraints);
  c.solver.solve(c.step, c.lambda);
  if (!(c.solver.residual(c.lambda, c.step, c.gamma) <= tolerance)) return false;
  return std::all_of(c.cones, c.cones + count, [&](const PackedCone& cone) { return inCone(cone, c.lambda); });
}

/// Writes to c.step the term that turns the rows' accelerations into those seen in fixed axes and at fixed points of space. The point that is in
/// contact after the step must not penetrate. It is not the point in contact now, which accelerates towards the centre where bodies roll.
void holdPlaces(const char* algorithm, const CompactModel& model, Data& data, VectorView q, VectorView v, ConstraintDataImpl& c) {
  placeRows(algorithm, model, data, q, &v, c);
  wantedAccelerations(c, c.gamma);
  std::copy_n(c.wanted, c.set.rows(), c.step);
  std::fill_n(c.v_after, model.nv(), 0.0);
  addTurning(model.impl(), v.data, c.v_after);
  addRowsOf(model.impl(), c, c.v_after, c.step);
}

/// Writes the accelerations under the rows' forces to d.ddq.
void accelerate(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const double* forces) {
  const CompactImpl& m = model.impl();
  if (c.by_inertia) {
    addMotionOf(m, c, forces, d.ddq);
  } else {
    if (forces) actOnBodies(m, d, c, forces);
    accelerateBodies(m, d, c, m.gravity, d.ddq);
  }
}

}  // namespace

ContactViews contactStep(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, double dt, ConstraintData& constraints,
                         const FrictionCone* cones, std::size_t count, const ContactSettings& settings) {
  const char* algorithm = "contactStep";
  checkConstraints(algorithm, model, data, constraints);
  checkSize(algorithm, "tau", tau, model.nv());
  if (!(dt > 0) || !std::isfinite(dt)) throw Error(ErrorCode::argument, "contactStep: the step of time must be positive");
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau}, &c.block);
  readCones(algorithm, c, cones, count, settings);
  for (std::size_t k = 0; k < count; ++k)
    if (c.cones[k].both_ways) c.cones[k].friction *= dt;
  const int rows = c.set.rows();
  holdPlaces(algorithm, model, data, q, v, c);
  freeMotion(algorithm, model, data, q, v, tau, nullptr, 0, false, c);
  for (int r = 0; r < rows; ++r) c.wanted[r] = c.motion.velocity[r] - dt * c.wanted[r];
  for (std::size_t k = 0; k < count; ++k) {
    const int normal = c.cones[k].normal();
    for (int r = c.cones[k].row; r <= normal && !c.cones[k].both_ways; ++r) c.wanted[r] += dt * c.step[r];
    c.wanted[normal] += allowance(c.cones[k], c.motion.velocity[normal], dt, settings.restitution);
  }
  ConeSolution found{true, 0};
  if (!holdAll(c, constraints.settings, count, settings.tolerance)) {
    found = c.cone_solver.solve(c.workspace, {rows, c.cones, count, c.wanted, true}, settings, c.lambda);
    std::copy_n(c.cone_solver.velocity(), rows, c.gamma);
  }
  ContactResidual residual{0, 0};
  std::fill_n(c.left, rows, 1.0);
  for (std::size_t k = 0; k < count; ++k) {
    const PackedCone& cone = c.cones[k];
    const double *x = c.lambda + cone.row, *u = c.gamma + cone.row;
    if (!cone.both_ways) residual.penetration = std::max(residual.penetration, -cone.sign * c.gamma[cone.normal()]);
    const double work = cone.both_ways   ? x[0] * u[0] + cone.friction * std::abs(u[0])
                        : cone.rows == 1 ? x[0] * u[0]
                                         : x[0] * u[0] + x[1] * u[1] + x[2] * (u[2] + cone.friction * std::hypot(u[0], u[1]));
    residual.complementarity = std::max(residual.complementarity, std::abs(work));
    std::fill_n(c.left + cone.row, cone.rows, 0.0);
  }
  for (int r = 0; r < rows; ++r) residual.penetration = std::max(residual.penetration, c.left[r] * std::abs(c.gamma[r]));
  for (int r = 0; r < rows; ++r) c.step[r] = c.lambda[r] / dt;
  accelerate(model, d, c, c.step);
  for (int k = 0; k < model.nv(); ++k) c.v_after[k] = v.data[k] + dt * d.ddq[k];
  for (std::size_t k = 0; k < count; ++k) {
    const int normal = c.cones[k].normal();
    c.gamma[normal] -= allowance(c.cones[k], c.motion.velocity[normal], dt, settings.restitution);
  }
  return {c.v_after, c.lambda, c.gamma, residual, found.converged, found.iterations};
}

ContactViews contactForces(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a, VectorView tau,
                           ConstraintData& constraints, const FrictionCone* cones, std::size_t count, const ContactSettings& settings) {
  const char* algorithm = "contactForces";
  checkConstraints(algorithm, model, data, constraints);
  checkSize(algorithm, "tau", tau, model.nv());
  checkSize(algorithm, "a", a, model.nv());
  const CompactImpl& m = model.impl();
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .a = &a, .tau = &tau}, &c.block);
  readCones(algorithm, c, cones, count, settings);
  const int rows = c.set.rows();
  const double* wanted = rnea(model, data, q, v, a, nullptr, 0);
  for (int k = 0; k < m.nv; ++k) c.v_after[k] = wanted[k] - tau.data[k];
  // The rows' accelerations at a; then their difference from the accelerations without row forces.
  placeRows(algorithm, model, data, q, &v, c);
  addRowsOf(m, c, a.data, c.gamma);
  wantedAccelerations(c, c.gamma);
  for (int r = 0; r < rows; ++r) c.step[r] = c.wanted[r];
  freeMotion(algorithm, model, data, q, v, tau, nullptr, 0, false, c);
  for (int r = 0; r < rows; ++r) c.wanted[r] = c.step[r] - c.wanted[r];
  const ConeSolution found = c.cone_solver.solve(c.workspace, {rows, c.cones, count, c.wanted, false}, settings, c.lambda);
  for (int k = 0; k < m.nv; ++k)
    for (int r = 0; r < rows; ++r) c.v_after[k] -= c.lambda[r] * c.J[static_cast<std::ptrdiff_t>(rows) * k + r];
  return {c.v_after, c.lambda, nullptr, {0, 0}, found.converged, found.iterations};
}

}  // namespace detail

}  // namespace dyn
