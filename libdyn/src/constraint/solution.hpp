// The steps that algorithms of constrained dynamics share.
#pragma once

#include "algorithm/inputs.hpp"
#include "constraint/constraint_data.hpp"
#include "kernels/constraint_table.hpp"

namespace dyn {

/// Throws Error(argument) unless both were made for the model.
void checkConstraints(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints);

/// Where the last recursion left the bodies, and the recursions of constraints that read them there.
struct PlacedBodies {
  const kernels::ConstraintRecursions& run;
  void* memory;
};
PlacedBodies placedBodies(DataImpl& d, const ConstraintDataImpl& c);

/// The articulated-body recursion up to the accelerations, in strips where the model has them. Throws Error(singular).
void articulateBodies(const char* algorithm, const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v,
                      const double* tau, const Force<double>* external);
/// What the rows' forces give to those bodies' degrees of freedom, by the shares of articulateRows, for accelerateBodies.
void actOnBodies(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* forces);
/// The rest of the recursion.
void accelerateBodies(const CompactImpl& m, DataImpl& d, const ConstraintDataImpl& c, const Vec3<double>& gravity, double* ddq);

/// After the outward pass: rows located, their forces written. v may be null. c.motion.velocity only if it is wanted.
void prepareRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v, bool velocity = true);

/// After `articulate`: shares, free accelerations as if the world fell up, and the Delassus matrix.
void articulateRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c);

/// Rows at one state, v null at rest, for what needs no dynamics: J, by columns of the user's degrees of freedom, and c.gamma, what velocities
/// give to the rows' accelerations beside their own bias.
void placeRows(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c);

/// The motion without constraint forces, by M or by the articulated recursion (c.by_inertia; models with followers always by M): the Delassus
/// matrix, and what the rows' accelerations lack, into c.wanted. By M, d.ddq has the accelerations. c.motion.velocity as prepareRows.
void freeMotion(const char* algorithm, const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                std::size_t count, bool by_inertia, ConstraintDataImpl& c, bool velocity = true);

/// What the rows' accelerations are to be beside `free` ones, bias and feedback included, into c.wanted.
void wantedAccelerations(ConstraintDataImpl& c, const double* free);
/// The same of one row beside what degrees of freedom yield, after articulateRows.
inline double wantedOfYielded(const ConstraintDataImpl& c, int row) { return -(c.workspace.carried[row] + c.motion.fall[row] + c.motion.drift[row]); }

}  // namespace dyn
