// SPDX-License-Identifier: BSD-2-Clause
// The steps that algorithms of constrained dynamics share.
#pragma once

#include "algorithm/support/inputs.hpp"
#include "constraint/constraint_data.hpp"
#include "kernels/isa/constraint_table.hpp"

namespace dyn {

/// Throws Error(argument) unless data and constraints were made for the model.
void checkConstraints(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints);

/// Throws Error(argument) unless the constraints were looked up in this model.
void checkSet(const char* algorithm, const CompactImpl& m, const ConstraintSet& set);
/// Throws Error(argument) unless an impact may have this restitution.
void checkRestitution(double restitution);

/// The memory in which the last recursion left the bodies, and the recursions of constraints that read it.
struct PlacedBodies {
  const kernels::ConstraintRecursions& run;
  void* memory;
};
PlacedBodies placedBodies(DataImpl& d, const ConstraintDataImpl& c);

/// The articulated-body recursion without its last pass, over lane groups if the model uses them and `external` is null. Throws Error(singular).
void articulateBodies(const char* algorithm, const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v,
                      const double* tau, const Force<double>* external);
/// Adds the response to the rows' forces to the bodies' degrees of freedom, by the projections of articulateRows, for accelerateBodies.
void actOnBodies(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* forces);
/// The last pass of the articulated-body recursion: the accelerations.
void accelerateBodies(const CompactImpl& m, DataImpl& d, const ConstraintDataImpl& c, const Vec3<double>& gravity, double* ddq);

/// After the outward pass: locates the rows and writes their unit forces. v may be null. c.motion.velocity is valid only if `velocity`.
void prepareRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v, bool velocity = true);

/// After articulateBodies: projections, free accelerations with an acceleration of -gravity of the world, and the Delassus matrix.
void articulateRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c);

/// The rows at one state, without dynamics: writes J, by columns of the user's degrees of freedom, and to c.gamma the effect of velocities on the
/// rows' accelerations, without the rows' own bias. v: null at rest.
void placeRows(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c);

/// The motion without constraint forces, by M (c.by_inertia; always for models with dependent joints) or by the articulated-body recursion. Computes
/// the Delassus matrix and writes to c.wanted the accelerations that the rows lack. By M, d.ddq gets the accelerations. c.motion.velocity as in
/// prepareRows.
void freeMotion(const char* algorithm, const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                std::size_t count, bool by_inertia, ConstraintDataImpl& c, bool velocity = true);

/// Writes to c.wanted the accelerations that the rows need in addition to `free`, bias and feedback included.
void wantedAccelerations(ConstraintDataImpl& c, const double* free);
/// The acceleration that the response of the degrees of freedom must give to a row, after articulateRows.
inline double wantedOfResponse(const ConstraintDataImpl& c, int row) {
  return -(c.workspace.carried[row] + c.motion.fall[row] + c.motion.drift[row]);
}

}  // namespace dyn
