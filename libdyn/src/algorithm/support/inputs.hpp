// SPDX-License-Identifier: BSD-2-Clause
// The first steps of every algorithm: check sizes, expand coordinates of models with couplings, evaluate the joints.
#pragma once

#include "data/data_impl.hpp"

#include <string>

namespace dyn {

/// Inputs in expanded coordinates. They are the user's own vectors if the model has no couplings.
struct Inputs {
  const double *q = nullptr, *v = nullptr, *a = nullptr;
  const double* user_q = nullptr;  ///< in the user's coordinates
};

/// Throw Error(size) that names the argument, its size and the size it must have, or Error(argument) for a null pointer.
void checkSize(const char* algorithm, const char* name, VectorView x, int wanted);
void checkShape(const char* algorithm, const char* name, const MatrixOut& x, int rows, int cols);
/// Throws Error(argument) if data was made for another model, or without the memory that the algorithm needs.
void checkData(const char* algorithm, const CompactModel& model, const Data& data, Need need = Need::state);

/// Throws Error(argument), which names the call to make before `function`, if the kinematics have not reached the wanted stage.
void checkStage(const char* function, KinematicsStage found, KinematicsStage wanted);

/// The arguments that a call has; null for others.
struct Arguments {
  VectorView *q = nullptr, *v = nullptr, *a = nullptr, *tau = nullptr;
};
/// Makes sure that no argument is overwritten by a result before it is read. Arguments in the memory of results, of data or `more`, are copied, and
/// the views then point to the copies. Nested calls do not copy these again. Other arguments, and arguments of wrong size, stay as they are.
void copyAliasedArguments(Data& data, const Arguments& arguments, const PackMemory* more = nullptr);

/// Checks the arguments, copies those that lie in memory of results, and expands them. Null v and a stand for zeros. With couplings, writes their
/// derivatives to data. Throws Error(size | argument).
Inputs readInputs(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a);

/// Throws Error(argument), which says that the quaternion, (cos, sin) pair or unit vector of body i's joint is zero.
[[noreturn]] void refuseZero(const char* argument, const CompactImpl& m, int i);

/// Throws Error(argument) if a quaternion, (cos, sin) pair or unit vector of the user's q is zero. NaN and infinity are not errors; they spread.
void checkConfiguration(const char* argument, const CompactImpl& m, const double* q);
/// Throws Error(argument) for a model with dependent joints. It is for algorithms that give the columns of all joints at once: with dependent joints,
/// the columns differ from frame to frame.
void refuseDependentJoints(const char* algorithm, const CompactImpl& m);
/// Throws Error(singular), which says why the pivot of this body's joint vanished or is not finite. q is in expanded coordinates. If it is null, the
/// message says less.
[[noreturn]] void refuseSingular(const char* algorithm, const CompactImpl& m, int body, const double* q);

/// Throws Error(singular) unless `failed_body` is 0 or q, in expanded coordinates, has NaN or infinity, which spread to the results. q may be null.
void checkFactors(const char* algorithm, const CompactImpl& m, int failed_body, const double* q = nullptr);

/// Computes poses, subspaces and (with v) biases of all joints, by one virtual call per batch. Throws Error(argument) for a zero quaternion.
void evaluateJoints(const CompactImpl& m, DataImpl& d, const double* q, const double* v);

/// Computes dS/dt at velocity v for the joints whose subspace varies, by one differentiated call per batch.
void evaluateSubspaceRates(const CompactImpl& m, DataImpl& d, const double* q, const double* v);
/// Returns column k of dS/dt of body i's joint in the body's axes. It is zero for constant subspaces.
Motion<double> subspaceRate(const CompactImpl& m, const DataImpl& d, int i, int k);

/// Writes tau less damping and friction to d.tau and returns it. Returns tau itself if the model has none. For models without couplings.
const double* lessDissipation(const CompactImpl& m, DataImpl& d, const double* tau, const double* v);

/// Reduces forces from expanded to the user's coordinates: each dependent joint's force is projected on its master. Overwrites `expanded`.
void reduceForces(const CompactImpl& m, const DataImpl& d, double* expanded, double* user);

}  // namespace dyn
