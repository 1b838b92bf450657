// The configuration space of a whole model: q (+) v, q1 (-) q0 and their Jacobians. v is a tangent vector as joint velocities are.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/data/views.hpp>

#include <cstdint>

namespace dyn {

/// Argument that a derivative is taken by.
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

// All O(n) but the Jacobians, O(nv^2) for writing them. Results are the caller's: returned as new vectors, or written to an argument,
// which does not allocate and may be an input. Quaternions and pairs are normalised where they are read. Throw Error(size), and all but
// isNormalized Error(argument) for a quaternion or pair that is zero; then nothing has been written.

/// The configuration at which every joint is at its zero.
inline Eigen::VectorXd neutral(const CompactModel& model) {
  Eigen::VectorXd q(model.nq());
  detail::neutral(model, q.data());
  return q;
}

/// q (+) v: where q gets in unit time at constant joint velocity v.
inline void integrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, const VectorOut& out) {
  detail::integrate(model, q, v, out);
}
inline Eigen::VectorXd integrate(const CompactModel& model, const VectorArg& q, const VectorArg& v) {
  Eigen::VectorXd out(model.nq());
  integrate(model, q, v, out);
  return out;
}

/// The v with q0 (+) v = q1, rotations by at most pi.
inline void difference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, const VectorOut& v) {
  detail::difference(model, q0, q1, v);
}
inline Eigen::VectorXd difference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1) {
  Eigen::VectorXd v(model.nv());
  difference(model, q0, q1, v);
  return v;
}

/// q0 (+) t (q1 (-) q0).
inline Eigen::VectorXd interpolate(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, double t) {
  Eigen::VectorXd v = difference(model, q0, q1);
  v *= t;
  return integrate(model, q0, v);
}
/// Norm of the difference: metres and radians count alike.
inline double distance(const CompactModel& model, const VectorArg& q0, const VectorArg& q1) { return difference(model, q0, q1).norm(); }

/// q with quaternions and (cos, sin) pairs of norm one.
inline void normalize(const CompactModel& model, const VectorArg& q, const VectorOut& out) { detail::normalize(model, q, out); }
inline Eigen::VectorXd normalize(const CompactModel& model, const VectorArg& q) {
  Eigen::VectorXd out(model.nq());
  normalize(model, q, out);
  return out;
}
/// Whether every quaternion and pair has norm one to the given tolerance.
inline bool isNormalized(const CompactModel& model, const VectorArg& q, double tolerance = 1e-12) {
  return detail::distanceFromSpace(model, q) <= tolerance;
}

/// Uniform within the limits; unlimited coordinates in [-pi, pi], unlimited positions of groups in [-1, 1]; where there is one limit, within a
/// range of at least 1 at it. Rotations are even over their group.
/// The same seed gives the same configuration.
inline Eigen::VectorXd randomConfiguration(const CompactModel& model, std::uint64_t seed) {
  Eigen::VectorXd q(model.nq());
  detail::randomConfiguration(model, seed, q.data());
  return q;
}

/// nv x nv derivative of integrate by q (ARG0) or v (ARG1), in tangent vectors.
inline void dIntegrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, ArgumentPosition by, const MatrixOut& J) {
  detail::dIntegrate(model, q, v, by, J);
}
inline Eigen::MatrixXd dIntegrate(const CompactModel& model, const VectorArg& q, const VectorArg& v, ArgumentPosition by) {
  Eigen::MatrixXd J(model.nv(), model.nv());
  dIntegrate(model, q, v, by, J);
  return J;
}

/// nv x nv derivative of difference by q0 (ARG0) or q1 (ARG1), in tangent vectors.
inline void dDifference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, ArgumentPosition by, const MatrixOut& J) {
  detail::dDifference(model, q0, q1, by, J);
}
inline Eigen::MatrixXd dDifference(const CompactModel& model, const VectorArg& q0, const VectorArg& q1, ArgumentPosition by) {
  Eigen::MatrixXd J(model.nv(), model.nv());
  dDifference(model, q0, q1, by, J);
  return J;
}

}  // namespace dyn
