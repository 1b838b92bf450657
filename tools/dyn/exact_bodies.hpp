// SPDX-License-Identifier: BSD-2-Clause
// A tree of bodies on joints, with fifty digits: poses and their motion, and sums over the bodies.
#pragma once

#include "exact_joint.hpp"

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>

namespace dyn::tool {

/// A body and the joint that carries it.
struct ExactBody {
  std::string name;
  ExactJoint joint;
  Series placement;
  int parent = 0, q = 0, v = 0;      ///< for a dependent joint, the coordinate and velocity of its master
  std::vector<double> coefficients;  ///< of a dependent joint's polynomial
  bool moves = false;                ///< a joint on its root path has freedom
  Mat inertia = Mat::Zero(3, 3);     ///< about the centre of mass
  Vec com = Vec::Zero(3);
  Real mass = 0;

  /// The number of velocities that move the joint.
  int freedom() const { return coefficients.empty() ? joint.nv : 1; }
};

/// The moment about a body's centre of mass that its motion needs: d/dt (R I R^T w), by the product rule on the series.
Vec momentOf(const ExactBody& body, const Series& x);

/// A configuration, and the joints' own poses there with their derivatives along the joints' velocities.
struct Place {
  struct Own {
    Mat R;
    Vec p;
  };
  struct Joint {
    Own at;
    std::vector<Own> first, second;  ///< by v_d, and by v_d and v_e, row after row
  };
  VectorR q;
  std::vector<Joint> joints;
};

/// Columns: velocities of points and angular velocities of the bodies, for unit joint velocities.
struct BodyJacobians {
  std::vector<MatrixR> linear, angular;  ///< 3 x nv
};

class ExactBodies {
 public:
  ExactBodies(const Model& description, const CompactModel& model);

  std::vector<ExactBody> bodies;
  std::vector<std::size_t> carried;  ///< the bodies that the compiled model's joints carry
  Vec gravity;
  int nv = 0;

  /// True if some joint depends on another one.
  bool follows() const;
  Place place(const VectorR& q) const;
  /// The configuration and its time derivatives, for joint velocities v with time derivatives a.
  std::vector<TimeSeries> coordinates(const VectorR& q, const VectorR& v, const VectorR& a) const;
  /// The place that the motion with constant joint velocities v reaches after the small time h, to second order in h.
  Place moved(const Place& from, const VectorR& v, const Real& h) const;

  /// The joint's own motion: not its placement, nor the motion of the parent.
  Series own(std::size_t body, const Place& at, const VectorR& v, const VectorR& a) const;
  std::vector<Series> motions(const Place& at, const VectorR& v, const VectorR& a) const;
  /// Jacobians of the bodies' centres of mass, or of their origins.
  BodyJacobians jacobians(const Place& at, bool of_origins = false) const;

  /// Torques by virtual work, and the inertia matrix as a sum over the bodies.
  VectorR rnea(const Place& at, const VectorR& v, const VectorR& a, const BodyJacobians& J) const;
  VectorR rnea(const Place& at, const VectorR& v, const VectorR& a) const { return rnea(at, v, a, jacobians(at)); }
  MatrixR massMatrix(const Place& at, const BodyJacobians& J) const;
  /// Upper bounds of the summands of each torque. Doubles suffice, as the digits of a scale do not matter.
  std::vector<double> scale(const Place& at, const VectorR& v, const VectorR& a) const;

  /// Derivatives of f by central differences of step h along each velocity of the configuration, and along the time of the motion with v.
  using OfPlace = std::function<MatrixR(const Place&)>;
  std::vector<MatrixR> byConfiguration(const Place& at, const OfPlace& f, const Real& h = Real(step)) const;
  MatrixR alongMotion(const Place& at, const VectorR& v, const OfPlace& f, const Real& h = Real(step)) const;

  /// The error of a difference is the square of its step, and the rounding error divided by the step: thirty digits are right.
  static constexpr double step = 1e-17;
};

/// Derivatives of f by each entry of x, by central differences of step h.
std::vector<MatrixR> byVector(const VectorR& x, const std::function<MatrixR(const VectorR&)>& f, const Real& h = Real(ExactBodies::step));

}  // namespace dyn::tool
