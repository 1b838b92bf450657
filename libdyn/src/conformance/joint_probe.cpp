// SPDX-License-Identifier: BSD-2-Clause
#include "conformance/joint_probe.hpp"

#include "joint/single.hpp"

namespace dyn::conformance {

namespace {

Eigen::MatrixXd rowMajor(const std::vector<double>& entries, int n) {
  Eigen::MatrixXd M(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) M(i, j) = entries[static_cast<std::size_t>(n * i + j)];
  return M;
}

std::size_t squareSize(int n) { return static_cast<std::size_t>(n * n + 1); }

}  // namespace

JointProbe::JointProbe(const JointType& type, const Parameters& parameters)
    : type_(type), checked_(checkParameters(parameters, type.info(), {})), arguments_(checked_.arguments()) {
  char message[256] = "";
  if (!type.prepare(arguments_.data(), instance_, message, sizeof message)) throw Error(ErrorCode::parameter, std::string("refused: ") + message);
  if (instance_.nv < 0 || instance_.nv > max_joint_nv || instance_.nq < instance_.nv || instance_.nq > max_joint_nq)
    throw Error(ErrorCode::parameter, "nq = " + std::to_string(instance_.nq) + ", nv = " + std::to_string(instance_.nv) +
                                          "; a joint has nv <= nq, at most 6 velocities and 7 coordinates");
  if (instance_.constant_count < 0) throw Error(ErrorCode::parameter, "its number of constants is negative");
  constants_.resize(static_cast<std::size_t>(instance_.constant_count));
  type.constants(arguments_.data(), constants_.data());
}

bool JointProbe::flat() const { return (type_.info().closed_forms & (instance_.shape == Shape::dense ? own_rates : closed_configuration)) == 0; }

template <class S>
JointMotion<S> JointProbe::motion(const S* q, const S* v) const {
  S pose[12], subspace[6 * max_joint_nv], bias[6];
  evaluateJoint(type_, instance_, constants_.data(), q, v, pose, subspace, bias);
  JointMotion<S> result;
  result.pose = poseFromComponents<S>(instance_.shape, pose);
  const kernels::Slot<S> slot{pose, subspace, 1, instance_.subspace, bias, 1, instance_.nv};
  kernels::withShape<S>(instance_.shape, nv(), [&]<class Kernel>() {
    const Kernel kernel(slot);
    for (int k = 0; k < nv(); ++k) result.columns[k] = kernel.column(k);
    if (v && instance_.shape == Shape::dense) result.bias = kernel.bias();
  });
  return result;
}
template JointMotion<double> JointProbe::motion(const double*, const double*) const;
template JointMotion<Dual<double>> JointProbe::motion(const Dual<double>*, const Dual<double>*) const;

JointPlace JointProbe::place() const { return {&type_, constants_.data(), instance_.constant_count}; }

Eigen::VectorXd JointProbe::rates(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  if (flat()) return v;
  const std::vector<Dual<double>> q0(q.begin(), q.end()), u(v.begin(), v.end());
  std::vector<Dual<double>> dq(static_cast<std::size_t>(nq()));
  ConfigurationBatch<Dual<double>> b = place().question<Dual<double>>();
  b.q0 = q0.data();
  b.v = u.data();
  b.q_out = dq.data();
  type_.rates(b);
  return Eigen::VectorXd::NullaryExpr(nq(), [&](Eigen::Index i) { return dq[static_cast<std::size_t>(i)].v; });
}

Eigen::VectorXd JointProbe::neutral() const {
  Eigen::VectorXd q(nq());
  ConfigurationBatch<double> b = place().question();
  b.q_out = q.data();
  type_.neutral(b);
  return q;
}

Eigen::VectorXd JointProbe::integrate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  Eigen::VectorXd out(nq());
  ConfigurationBatch<double> b = place().question();
  b.q0 = q.data();
  b.v = v.data();
  b.q_out = out.data();
  type_.integrate(b);
  return out;
}

Eigen::VectorXd JointProbe::difference(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
  Eigen::VectorXd out(nv());
  ConfigurationBatch<double> b = place().question();
  b.q0 = q0.data();
  b.q1 = q1.data();
  b.v_out = out.data();
  type_.difference(b);
  return out;
}

JointProbe::Jacobians JointProbe::dIntegrate(const Eigen::VectorXd& q, const Eigen::VectorXd& v) const {
  std::vector<double> first(squareSize(nv())), second(squareSize(nv()));
  ConfigurationBatch<double> b = place().question();
  b.q0 = q.data();
  b.v = v.data();
  b.J_q = first.data();
  b.J_v = second.data();
  type_.integrate(b);
  return {rowMajor(first, nv()), rowMajor(second, nv())};
}

JointProbe::Jacobians JointProbe::dDifference(const Eigen::VectorXd& q0, const Eigen::VectorXd& q1) const {
  std::vector<double> first(squareSize(nv())), second(squareSize(nv()));
  ConfigurationBatch<double> b = place().question();
  b.q0 = q0.data();
  b.q1 = q1.data();
  b.J_q = first.data();
  b.J_v = second.data();
  type_.difference(b);
  return {rowMajor(first, nv()), rowMajor(second, nv())};
}

Eigen::VectorXd JointProbe::normalize(const Eigen::VectorXd& q, double& distance) const {
  Eigen::VectorXd out(nq());
  ConfigurationBatch<double> b = place().question();
  b.q0 = q.data();
  b.q_out = out.data();
  b.v_out = &distance;
  type_.normalize(b);
  return out;
}

}  // namespace dyn::conformance
