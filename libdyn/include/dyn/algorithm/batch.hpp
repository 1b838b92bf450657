// SPDX-License-Identifier: BSD-2-Clause
// The algorithms over many states (a batch).
#pragma once

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/catalogue/algorithm.hpp>
#include <dyn/data/batch_data.hpp>
#include <dyn/data/states.hpp>

#include <type_traits>

namespace dyn {

namespace detail {

template <class T>
using StatesResult = Eigen::Map<const Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>>;

/// Pointers to the first number of each result of an algorithm, in the order of the catalogue. Results that a call leaves out have no rows.
template <class T>
struct BatchViews {
  const T* results[4] = {};
  std::ptrdiff_t rows[4] = {}, states = 0;
  StatesResult<T> operator()(std::size_t k) const { return {results[k], rows[k], states}; }
};
/// For forward dynamics, `a` is tau. If v or a is not given, it counts as zero.
template <class T>
DYN_API BatchViews<T> runBatch(const CompactModel&, BasicBatchData<T>&, Algorithm, StatesView<T> q, StatesView<T> v, StatesView<T> a);
template <class T>
DYN_API BatchViews<T> batchJacobians(const CompactModel&, BasicBatchData<T>&, StatesView<T> q, Kind kind, int id, ReferenceFrame);
template <class T>
DYN_API void batchFactors(const CompactModel&, BasicBatchData<T>&, StatesView<T> q);
template <class T>
DYN_API BatchViews<T> batchSolve(const CompactModel&, BasicBatchData<T>&, StatesView<T> x);
template <class T>
DYN_API void batchKinematics(const CompactModel&, BasicBatchData<T>&, StatesView<T> q, StatesView<T> v, StatesView<T> a);

/// The compiler does not deduce T from such an argument, so any matrix converts to it.
template <class T>
using States = StatesArg<std::type_identity_t<T>>;

}  // namespace detail

/// Runs one algorithm of the catalogue, for programs that loop over the catalogue. The batch must have been made with info(algorithm).batch_need.
/// Result k is output k of info(algorithm), one column per state. For aba and its derivatives, A is tau. Throws what the algorithm's own function
/// throws, and Error(argument) for algorithms that are not batched or read more than q, v and a or tau.
///
/// This and all functions of a batch take one state per column, nq or nv rows and 1 to `capacity` columns, and throw Error(size) otherwise. Each
/// column of a result belongs to one state, too. For a zero quaternion the functions throw Error(argument), which names the state; the results of the
/// other states are valid then. The batch owns the results until its next call.
template <class T>
detail::BatchViews<T> runAlgorithm(const CompactModel& model, BasicBatchData<T>& data, Algorithm algorithm, const detail::States<T>& Q,
                                   const detail::States<T>& V, const detail::States<T>& A) {
  return detail::runBatch<T>(model, data, algorithm, Q, V, A);
}

/// Computes the joint forces tau [N m, N], nv x N, as rnea does for one state.
template <class T>
auto rnea(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V, const detail::States<T>& A) {
  return detail::runBatch<T>(model, data, Algorithm::rnea, Q, V, A)(0);
}
/// Computes rnea at zero acceleration [N m, N], nv x N.
template <class T>
auto nonLinearEffects(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  return detail::runBatch<T>(model, data, Algorithm::nle, Q, V, {})(0);
}
/// Computes rnea at rest (v = a = 0) [N m, N], nv x N.
template <class T>
auto generalizedGravity(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::gravity, Q, {}, {})(0);
}
/// Computes mass matrices. Each column of the result is one, of nv * nv numbers. The batch must have been made with Need::mass_matrix.
template <class T>
auto crba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::mass_matrix, Q, {}, {})(0);
}
/// Computes joint accelerations [rad/s^2, m/s^2], nv x N. Throws Error(singular), which names the joint and the state, where M is singular. The
/// columns of such states are NaN; the other columns are right. A model with dependent joints goes through M.
template <class T>
auto aba(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V, const detail::States<T>& Tau) {
  return detail::runBatch<T>(model, data, Algorithm::aba, Q, V, Tau)(0);
}

/// The centre of mass in each state and its motion, in world axes. `velocity` and `acceleration` have no rows if the call had no V or A.
template <class T>
struct CentersOfMass {
  detail::StatesResult<T> position,  ///< [m], 3 x N
      velocity,                      ///< [m/s], 3 x N
      acceleration;                  ///< [m/s^2], 3 x N; gravity not included
};
namespace detail {
template <class T>
CentersOfMass<T> batchCentersOfMass(const CompactModel& model, BasicBatchData<T>& data, StatesView<T> q, StatesView<T> v, StatesView<T> a) {
  const BatchViews<T> x = runBatch<T>(model, data, Algorithm::center_of_mass, q, v, a);
  return {x(0), x(1), x(2)};
}
}  // namespace detail

/// Computes the centre of mass; with V its velocity, too; with A also its acceleration. The centre of a model without mass is NaN.
/// @{
template <class T>
CentersOfMass<T> centerOfMass(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::batchCentersOfMass<T>(model, data, Q, {}, {});
}
template <class T>
CentersOfMass<T> centerOfMass(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  return detail::batchCentersOfMass<T>(model, data, Q, V, {});
}
template <class T>
CentersOfMass<T> centerOfMass(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V,
                              const detail::States<T>& A) {
  return detail::batchCentersOfMass<T>(model, data, Q, V, A);
}
/// @}
/// Computes Jacobians of the centre of mass. Each column of the result is one of 3 x nv numbers. The batch must have been made with
/// Need::derivatives.
template <class T>
auto jacobianCenterOfMass(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::center_of_mass_jacobian, Q, {}, {})(0);
}
/// Computes kinetic energies [J], 1 x N, armature included.
template <class T>
auto computeKineticEnergy(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  return detail::runBatch<T>(model, data, Algorithm::energies, Q, V, {})(0);
}
/// Computes potential energies [J], 1 x N.
template <class T>
auto computePotentialEnergy(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::runBatch<T>(model, data, Algorithm::energies, Q, {}, {})(1);
}

namespace cholesky {

/// Computes factors of M^-1 = U^T D^-1 U, as the recursion of aba finds them, and keeps them for solve(). Unlike decompose() of a Data it takes Q,
/// and needs no M; so M's condition costs no digits. The batch must have been made with Need::derivatives. Throws Error(singular), which names the
/// joint and the state, where M is singular; the factors of such a state are NaN, the others are right. Throws Error(argument) for a model with
/// dependent joints. O(n depth) a state.
template <class T>
void decompose(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  detail::batchFactors<T>(model, data, Q);
}
/// Computes M^-1 b, nv x N, for a column b of each state of the last decompose(). The result shares memory with that of aba. Throws Error(size), and
/// Error(argument) before decompose(). O(n depth) a state.
template <class T>
auto solve(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& B) {
  return detail::batchSolve<T>(model, data, B)(0);
}

}  // namespace cholesky

/// Computes Jacobians. Each column of the result is one of 6 x nv numbers, as the function of the same name writes it for one state. The batch must
/// have been made with Need::jacobians. Throws Error(argument) for a joint or frame number out of range; computeJointJacobians throws it for a model
/// with dependent joints.
/// @{
template <class T>
auto computeJointJacobians(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  return detail::batchJacobians<T>(model, data, Q, detail::Kind::all_joints, 0, ReferenceFrame::WORLD)(0);
}
template <class T>
auto computeJointJacobian(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, int joint, ReferenceFrame reference) {
  return detail::batchJacobians<T>(model, data, Q, detail::Kind::joint, joint, reference)(0);
}
template <class T>
auto computeFrameJacobian(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, int frame, ReferenceFrame reference) {
  return detail::batchJacobians<T>(model, data, Q, detail::Kind::frame, frame, reference)(0);
}
/// @}

/// Computes the poses of all joints; with V their velocities, too; with A also their accelerations. The functions below read them. The batch
/// must have been made with Need::kinematics.
/// @{
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q) {
  detail::batchKinematics<T>(model, data, Q, {}, {});
}
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V) {
  detail::batchKinematics<T>(model, data, Q, V, {});
}
template <class T>
void forwardKinematics(const CompactModel& model, BasicBatchData<T>& data, const detail::States<T>& Q, const detail::States<T>& V,
                       const detail::States<T>& A) {
  detail::batchKinematics<T>(model, data, Q, V, A);
}
/// @}

/// Returns a frame's pose in the world, spatial velocity or spatial acceleration in one state, as the last forwardKinematics found it. O(1).
/// Throws Error(argument) for a frame number out of range, a state that the last forwardKinematics did not have, a batch of another model or without
/// Need::kinematics, and if the last forwardKinematics had no V or A where one is needed.
/// @{
template <class T>
DYN_API SE3<T> framePlacement(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state);
template <class T>
DYN_API Motion<T> frameVelocity(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference);
template <class T>
DYN_API Motion<T> frameAcceleration(const CompactModel& model, const BasicBatchData<T>& data, int frame, int state, ReferenceFrame reference);
/// @}

}  // namespace dyn
