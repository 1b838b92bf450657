// What every algorithm does first: check sizes, spread coupled coordinates, ask the joint types for their poses.
#pragma once

#include "data/data_impl.hpp"

#include <string>

namespace dyn {

/// Expanded vectors: the user's own where the model has no couplings.
struct Inputs {
  const double *q = nullptr, *v = nullptr, *a = nullptr;
  const double* user_q = nullptr;  ///< as it was given
};

/// Throws Error(size) naming the argument, what it has and what it wants.
void checkSize(const char* algorithm, const char* name, VectorView x, int wanted);
void checkShape(const char* algorithm, const char* name, const MatrixOut& x, int rows, int cols);
/// Throws Error(argument) when data was made for another model, or without what the algorithm needs.
void checkData(const char* algorithm, const CompactModel& model, const Data& data, Need need = Need::state);

/// Throws Error(argument) naming the call that brings kinematics to where `function` reads them.
void checkStage(const char* function, KinematicsStage found, KinematicsStage wanted);

/// Those that a call has.
struct Arguments {
  VectorView *q = nullptr, *v = nullptr, *a = nullptr, *tau = nullptr;
};
/// What is read after the first result has been written must not be one: arguments that lie in memory of results, data's or those in `more`, are
/// copied, and the views turned to the copies, which calls within this one leave where they are. Others, and those of wrong size, stay.
void keepArguments(Data& data, const Arguments& arguments, const PackMemory* more = nullptr);

/// Checks, keeps and expands; v and a may be null views. Leaves couplings' derivatives in data.
Inputs readInputs(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a);

/// Throws Error(argument): the quaternion or (cos, sin) pair of body i's joint is zero.
[[noreturn]] void refuseZero(const char* argument, const CompactImpl& m, int i);

/// A quaternion or (cos, sin) pair of q that is zero stands for no rotation: throws, where NaN and infinity just spread.
void checkConfiguration(const char* argument, const CompactImpl& m, const double* q);
/// Throws Error(argument) for a model with joints that follow others: the algorithm has columns for all joints at once, and theirs differ
/// from frame to frame.
void refuseFollowers(const char* algorithm, const CompactImpl& m);
/// Throws Error(singular): the pivot of this body's joint vanished, or is not finite; says why, as far as q, expanded, or null, tells.
[[noreturn]] void refuseSingular(const char* algorithm, const CompactImpl& m, int body, const double* q);

/// Throws Error(singular) unless `failed_body` is 0. Not where q, expanded, if it is given, has NaN or infinity, which just spread.
void checkFactors(const char* algorithm, const CompactImpl& m, int failed_body, const double* q = nullptr);

/// One virtual call a batch: poses, subspaces, and (with v) biases. Throws Error(argument) for a zero quaternion.
void evaluateJoints(const CompactImpl& m, DataImpl& d, const double* q, const double* v);

/// dS/dt along v of the joints whose subspace varies, by one differentiated call a batch.
void evaluateSubspaceRates(const CompactImpl& m, DataImpl& d, const double* q, const double* v);
/// Column k of dS/dt of body i in its own axes; zero for constant subspaces.
Motion<double> subspaceRate(const CompactImpl& m, const DataImpl& d, int i, int k);

/// tau less damping and friction, in d.tau; tau itself where the model has none. Without couplings.
const double* lessLosses(const CompactImpl& m, DataImpl& d, const double* tau, const double* v);

/// tau_x of the expanded coordinates to the user's: each follower's share goes to its master. Works in place on `expanded`.
void reduceForces(const CompactImpl& m, const DataImpl& d, double* expanded, double* user);

}  // namespace dyn
