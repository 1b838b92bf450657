// The steps that algorithms of constrained dynamics share.
#pragma once

#include "algorithm/inputs.hpp"
#include "constraint/constraint_data.hpp"

namespace dyn {

/// Throws Error(argument) unless both were made for the model.
void checkConstraints(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints);

/// After the kernel's outward pass: rows located, their forces written. v may be null.
void prepareRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const double* q, const double* v);

/// After `articulate`: shares, free accelerations (under gravity, or without), and the Delassus matrix.
void articulateRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, bool gravity);

/// J, by columns of the user's degrees of freedom, and c.gamma, what velocities give to the rows' accelerations beside their own bias.
/// After placeOutward and prepareRows.
void rigidRows(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c);

/// What the rows' accelerations are to be beside `free` ones, bias and feedback included, into c.wanted.
void wantedAccelerations(ConstraintDataImpl& c, const double* free);

}  // namespace dyn
