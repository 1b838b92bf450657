// SPDX-License-Identifier: BSD-2-Clause
// The configuration space of a whole model: q (+) v, q1 (-) q0 and their Jacobians. v is a tangent vector, as joint velocities are.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>

#include <cstdint>

namespace dyn {

/// The argument by which a derivative is taken: ARG0 is the first (q or q0), ARG1 the second (v or q1).
enum class ArgumentPosition { ARG0, ARG1 };

namespace detail {
DYN_API void neutral(const CompactModel&, double* q);
DYN_API void integrate(const CompactModel&, VectorView q, VectorView v, const VectorOut& out);
DYN_API void difference(const CompactModel&, VectorView q0, VectorView q1, const VectorOut& v);
DYN_API void normalize(const CompactModel&, VectorView q, const VectorOut& out);
DYN_API double distanceFromSpace(const CompactModel&, VectorView q);
DYN_API void randomConfiguration(const CompactModel&, std::uint64_t seed, double* q);
DYN_API void dIntegrate(const CompactModel&, VectorView q, VectorView v, ArgumentPosition by, const MatrixOut& J);
DYN_API void dDifference(const CompactModel&, VectorView q0, VectorView q1, ArgumentPosition by, const MatrixOut& J);
}  // namespace detail

/// Returns the configuration at which every joint is at its zero. O(n).
inline Eigen::VectorXd neutral(const CompactModel& model) {
  Eigen::VectorXd q(model.nq());
  detail::neutral(model, q.data());
  return q;
}

/// Computes q (+) v, the configuration that q reaches in unit time at constant joint velocity v. O(n).
///
/// This and the functions below return their result as a new vector or matrix, or write it to an argument. The latter does not allocate, and the
/// argument may also be an input. Quaternions and (cos, sin) pairs are normalised when they are read. The functions throw Error(size), and
/// Error(argument) for a zero quaternion or pair; they have written nothing then.
/// @{
inline void integrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, const VectorOut& out) {
  detail::integrate(model, q, v, out);
}
inline Eigen::VectorXd integrate(const CompactModel& model, const VectorArg& q, const VectorArg& v) {
  Eigen::VectorXd out(model.nq());
  integrate(model, q, v, out);
  return out;
}
/// @}

/// Computes the v for which q0 (+) v = q1. Its rotations are by at most pi. O(n).
/// @{
inline void difference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, const VectorOut& v) {
  detail::difference(model, q0, q1, v);
}
inline Eigen::VectorXd difference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1) {
  Eigen::VectorXd v(model.nv());
  difference(model, q0, q1, v);
  return v;
}
/// @}

/// Returns q0 (+) t (q1 (-) q0). O(n).
inline Eigen::VectorXd interpolate(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, double t) {
  Eigen::VectorXd v = difference(model, q0, q1);
  v *= t;
  return integrate(model, q0, v);
}
/// Returns the norm of the difference. Metres and radians count alike. O(n).
inline double distance(const CompactModel& model, const VectorArg& q0, const VectorArg& q1) { return difference(model, q0, q1).norm(); }

/// Computes q with its quaternions and (cos, sin) pairs scaled to norm one. O(n).
/// @{
inline void normalize(const CompactModel& model, const VectorArg& q, const VectorOut& out) { detail::normalize(model, q, out); }
inline Eigen::VectorXd normalize(const CompactModel& model, const VectorArg& q) {
  Eigen::VectorXd out(model.nq());
  normalize(model, q, out);
  return out;
}
/// @}
/// Returns true if every quaternion and pair has norm one to within the tolerance. Throws only Error(size).
inline bool isNormalized(const CompactModel& model, const VectorArg& q, double tolerance = 1e-12) {
  return detail::distanceFromSpace(model, q) <= tolerance;
}

/// Returns a random configuration. Coordinates are uniform within their limits. A missing limit is replaced by -pi or pi, or by -1 or 1 for
/// positions of free and planar joints; if only one limit is missing, the range is made at least 1 long. Rotations are uniform over their group.
/// The same seed gives the same configuration.
inline Eigen::VectorXd randomConfiguration(const CompactModel& model, std::uint64_t seed) {
  Eigen::VectorXd q(model.nq());
  detail::randomConfiguration(model, seed, q.data());
  return q;
}

/// Computes the nv x nv derivative of integrate by q (ARG0) or v (ARG1), in tangent vectors. O(nv^2), because all entries are written.
/// @{
inline void dIntegrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, ArgumentPosition by, const MatrixOut& J) {
  detail::dIntegrate(model, q, v, by, J);
}
inline Eigen::MatrixXd dIntegrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, ArgumentPosition by) {
  Eigen::MatrixXd J(model.nv(), model.nv());
  dIntegrate(model, q, v, by, J);
  return J;
}
/// @}

/// Computes the nv x nv derivative of difference by q0 (ARG0) or q1 (ARG1), in tangent vectors. O(nv^2).
/// @{
inline void dDifference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, ArgumentPosition by, const MatrixOut& J) {
  detail::dDifference(model, q0, q1, by, J);
}
inline Eigen::MatrixXd dDifference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, ArgumentPosition by) {
  Eigen::MatrixXd J(model.nv(), model.nv());
  dDifference(model, q0, q1, by, J);
  return J;
}
/// @}

}  // namespace dyn
