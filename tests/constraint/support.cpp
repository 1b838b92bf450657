// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/support.hpp"

#include <dyn/parsers/urdf.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>

namespace dyn::test {

CompactModel biped() {
  urdf::Options o;
  o.root = "free_flyer";
  return compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", o), registry());
}

ConstraintDescription renamed(ConstraintDescription c, const std::string& name) {
  c.name = name;
  return c;
}

DenseRows denseRows(const CompactModel& model, Data& data, const std::vector<ConstraintDescription>& set, const Eigen::VectorXd& q,
                    const Eigen::VectorXd& v) {
  DenseRows out;
  std::vector<Eigen::VectorXd> rows;
  std::vector<double> velocities, gammas;
  for (const ConstraintDescription& d : set) {
    const auto& c = std::get<FrameConstraint>(d.relation);
    const int ids[2] = {model.frameId(c.frame), model.frameId(c.other)};
    Eigen::MatrixXd J[2];
    SE3<double> pose[2];
    Eigen::Vector3d velocity[2], w[2], acceleration[2], alpha[2];
    for (int e = 0; e < 2; ++e) {
      J[e].resize(6, model.nv());
      computeFrameJacobian(model, data, q, ids[e], ReferenceFrame::LOCAL_WORLD_ALIGNED, J[e]);
    }
    forwardKinematics(model, data, q, v, Eigen::VectorXd::Zero(model.nv()));
    for (int e = 0; e < 2; ++e) {
      pose[e] = framePlacement(model, data, ids[e]);
      const Motion<double> m = frameVelocity(model, data, ids[e], ReferenceFrame::LOCAL_WORLD_ALIGNED);
      const Motion<double> a = frameClassicalAcceleration(model, data, ids[e], ReferenceFrame::LOCAL_WORLD_ALIGNED);
      velocity[e] = toEigen(m.linear);
      w[e] = toEigen(m.angular);
      acceleration[e] = toEigen(a.linear);
      alpha[e] = toEigen(a.angular);
    }
    const Eigen::Vector3d arm = toEigen(pose[0].p - pose[1].p);
    Eigen::MatrixXd relative = J[0] - J[1];
    for (int k = 0; k < model.nv(); ++k) {
      const Eigen::Vector3d turning = J[1].col(k).tail<3>();
      relative.col(k).head<3>() -= turning.cross(arm);
    }
    const Eigen::Vector3d V = velocity[0] - velocity[1] - w[1].cross(arm), W = w[0] - w[1];
    Eigen::Vector3d dV = acceleration[0] - acceleration[1] - alpha[1].cross(arm) - w[1].cross(w[1].cross(arm)) - w[1].cross(V);
    Eigen::Vector3d dW = alpha[0] - alpha[1];
    Eigen::Matrix3d E = Eigen::Matrix3d::Identity();
    Eigen::Vector3d turning = Eigen::Vector3d::Zero();
    if (c.axes != ConstraintAxes::LOCAL_WORLD_ALIGNED) {
      const int e = c.axes == ConstraintAxes::LOCAL ? 0 : 1;
      E = toEigen(pose[e].R);
      turning = w[e];
    }
    const bool point = c.free == std::array<bool, 6>{false, false, false, true, true, true} && c.axes == ConstraintAxes::LOCAL;
    if (!point) dV -= turning.cross(V);
    dW -= turning.cross(W);
    for (int k = 0; k < 6; ++k) {
      if (c.free[static_cast<std::size_t>(k)]) continue;
      const Eigen::Vector3d axis = E.col(k % 3);
      rows.emplace_back((axis.transpose() * (k < 3 ? relative.topRows<3>() : relative.bottomRows<3>())).transpose());
      velocities.push_back(axis.dot(k < 3 ? V : W));
      gammas.push_back(axis.dot(k < 3 ? dV : dW));
    }
  }
  out.J.resize(static_cast<Eigen::Index>(rows.size()), model.nv());
  for (std::size_t r = 0; r < rows.size(); ++r) out.J.row(static_cast<Eigen::Index>(r)) = rows[r].transpose();
  out.velocity = Eigen::Map<Eigen::VectorXd>(velocities.data(), static_cast<Eigen::Index>(velocities.size()));
  out.gamma = Eigen::Map<Eigen::VectorXd>(gammas.data(), static_cast<Eigen::Index>(gammas.size()));
  return out;
}

DenseSolution solveKkt(const Eigen::MatrixXd& M, const Eigen::MatrixXd& J, const LongVector& f, const LongVector& b) {
  const LongMatrix Ml = M.cast<long double>(), Jl = J.cast<long double>();
  const Eigen::LDLT<LongMatrix> factors(Ml);
  const LongMatrix X = factors.solve(LongMatrix(Jl.transpose()));
  const LongVector free = factors.solve(f);
  Eigen::CompleteOrthogonalDecomposition<LongMatrix> D;
  D.setThreshold(1e-13L);
  D.compute(Jl * X);
  DenseSolution out;
  out.lambda = D.solve(LongVector(b - Jl * free));
  out.x = free + X * out.lambda;
  return out;
}

double relativeTo(const Eigen::VectorXd& x, const LongVector& reference) {
  return static_cast<double>((x.cast<long double>() - reference).cwiseAbs().maxCoeff() / std::max(1.0L, reference.cwiseAbs().maxCoeff()));
}

Subject randomScene(std::uint64_t seed, int bodies, int constraints) {
  Random random(seed);
  const Model description = randomTree(registry(), bodies, seed, seed % 2 == 0);
  const CompactModel model = compile(description, registry());
  Subject s{model, {}, {}, {}, {}};
  std::vector<std::string> names;
  for (const FrameRecord& f : model.frames()) names.push_back(f.name);
  for (int k = 0; k < constraints; ++k) {
    FrameConstraint c;
    do {
      c.frame = names[static_cast<std::size_t>(random.below(static_cast<int>(names.size())))];
      c.other = random.below(2) == 0 ? "universe" : names[static_cast<std::size_t>(random.below(static_cast<int>(names.size())))];
    } while (model.frames()[static_cast<std::size_t>(model.frameId(c.frame))].joint ==
             model.frames()[static_cast<std::size_t>(model.frameId(c.other))].joint);
    const int kind = random.below(4);
    if (kind == 0) c.free = {false, false, false, true, true, true};
    if (kind > 1)
      for (bool& free : c.free) free = random.below(2) == 0;
    c.free[static_cast<std::size_t>(random.below(6))] = false;
    c.axes = static_cast<ConstraintAxes>(random.below(3));
    ConstraintDescription d;
    d.name = "c" + std::to_string(k);
    d.relation = c;
    s.constraints.push_back(d);
  }
  s.q = integrate(model, neutral(model), random.vector(model.nv(), 1));
  s.v = random.vector(model.nv(), 1);
  s.tau = random.vector(model.nv(), 5);
  return s;
}

}  // namespace dyn::test
