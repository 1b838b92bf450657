// SPDX-License-Identifier: BSD-2-Clause
// One joint of a type, evaluated at one configuration at a time. Results are unpacked from the batch.
#pragma once

#include "compile/parameters.hpp"
#include "joint/coordinate.hpp"
#include "joint/pose_components.hpp"
#include "kernels/body/shapes.hpp"

#include <Eigen/Core>

namespace dyn::conformance {

/// The core motion: pose, columns of S in the moving frame and, for dense shapes with a velocity, the bias (dS/dt) v.
template <class S>
struct JointMotion {
  SE3<S> pose;
  Motion<S> columns[max_joint_nv];
  Motion<S> bias;
};

class JointProbe {
 public:
  /// Throws Error(parameter) when the parameters do not fit the schema or the type refuses them.
  JointProbe(const JointType& type, const Parameters& parameters);

  const JointType& type() const { return type_; }
  const JointInstance& instance() const { return instance_; }
  const std::vector<ParameterArgument>& arguments() const { return arguments_; }
  const std::vector<double>& constants() const { return constants_; }
  int nq() const { return instance_.nq; }
  int nv() const { return instance_.nv; }
  /// Whether v = dq/dt.
  bool flat() const;

  /// v may be null.
  template <class S>
  JointMotion<S> motion(const S* q, const S* v) const;
  JointMotion<double> motion(const Eigen::VectorXd& q) const { return motion<double>(q.data(), nullptr); }
  SE3<double> pose(const Eigen::VectorXd& q) const { return motion(q).pose; }

  Eigen::VectorXd neutral() const;
  Eigen::VectorXd integrate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  /// Returns dq/dt for velocities v. Only for types with v = dq/dt or with rates of their own.
  Eigen::VectorXd rates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  Eigen::VectorXd difference(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const;
  /// Derivatives by the first and by the second argument.
  struct Jacobians {
    Eigen::MatrixXd first, second;
  };
  Jacobians dIntegrate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const;
  Jacobians dDifference(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const;
  /// Returns q normalised, and in `distance` how far q was from the configuration space.
  Eigen::VectorXd normalize(const Eigen::VectorXd& q, double& distance) const;

 private:
  JointPlace place() const;

  const JointType& type_;
  CheckedParameters checked_;
  std::vector<ParameterArgument> arguments_;
  JointInstance instance_;
  std::vector<double> constants_;
};

}  // namespace dyn::conformance
