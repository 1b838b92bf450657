// SPDX-License-Identifier: BSD-2-Clause
// Closed loops: two frames that coincide in the directions that are not free, without feedback. Forces follow from the dense equations of motion.
#include "exact_quantities.hpp"

#include <algorithm>

namespace dyn::tool {

namespace {

/// One side of a loop.
struct Side {
  std::size_t body = 0;
  Series placement;
};
Side sideOf(const Model& description, const std::string& name, const SE3<double>& placement) {
  const Series own = exactPlacement(placement);
  for (const FrameDescription& frame : description.frames)
    if (frame.name == name) return {static_cast<std::size_t>(frame.body), exactPlacement(frame.placement) * own};
  return {static_cast<std::size_t>(description.findBody(name)), own};
}

struct Loop {
  Side frame, other;
  std::array<bool, 6> free;
  ConstraintAxes axes;
};

/// J: relative velocities of the constraints' frames in their axes, one row for each direction that is not free.
MatrixR jacobianOf(const ExactBodies& x, const std::vector<Loop>& loops, const Place& at) {
  std::vector<VectorR> columns;
  for (int k = 0; k < x.nv; ++k) {
    const std::vector<Series> moved = x.motions(at, VectorR::Unit(x.nv, k), VectorR::Zero(x.nv));
    std::vector<Real> rows;
    for (const Loop& loop : loops) {
      const Series F = moved[loop.frame.body] * loop.frame.placement, O = moved[loop.other.body] * loop.other.placement;
      const Vec velocity = F.p[1] - O.p[1] - cross(O.omega()) * (F.p[0] - O.p[0]), turn = F.omega() - O.omega();
      const Mat axes = loop.axes == ConstraintAxes::LOCAL ? F.R[0] : loop.axes == ConstraintAxes::OTHER ? O.R[0] : Mat::Identity(3);
      const Vec own = axes.transpose() * velocity, own_turn = axes.transpose() * turn;
      for (int d = 0; d < 6; ++d)
        if (!loop.free[static_cast<std::size_t>(d)]) rows.push_back(d < 3 ? own[d] : own_turn[d - 3]);
    }
    VectorR& column = columns.emplace_back(static_cast<Eigen::Index>(rows.size()));
    std::copy(rows.begin(), rows.end(), column.data());
  }
  return MatrixR::ofColumns(columns);
}

/// The x of least norm for which G x = b, where G is positive semi-definite and b in its range. With independent rows C of G, G = C^T G_s^-1 C.
VectorR leastNorm(const MatrixR& G, const VectorR& b) {
  MatrixR left = G;  // what elimination of the chosen rows leaves
  std::vector<Eigen::Index> chosen;
  const auto pivot = [&left] {
    Eigen::Index largest = 0;
    for (Eigen::Index k = 1; k < left.rows(); ++k)
      if (left(largest, largest) < left(k, k)) largest = k;
    return largest;
  };
  const Real smallest = Real(1e-20) * G(pivot(), pivot());
  for (Eigen::Index k = pivot(); smallest < left(k, k); k = pivot()) {
    chosen.push_back(k);
    const VectorR column = left.col(k);
    const Real by = Real(1) / column[k];
    for (Eigen::Index c = 0; c < G.cols(); ++c) left.col(c) -= column * (column[c] * by);
  }
  const auto rank = static_cast<Eigen::Index>(chosen.size());
  MatrixR C(rank, G.cols()), G_s(rank, rank);
  for (Eigen::Index k = 0; k < rank; ++k) {
    C.row(k) = G.row(chosen[static_cast<std::size_t>(k)]);
    for (Eigen::Index l = 0; l < rank; ++l) G_s(k, l) = C(k, chosen[static_cast<std::size_t>(l)]);
  }
  const MatrixR square = (C * C.transpose()).inverse();
  return C.transpose() * (square * (G_s * (square * (C * b))));
}

}  // namespace

Quantities loopsOf(const ExactBodies& x, const Model& description, const State& state) {
  std::vector<Loop> loops;
  for (const ConstraintDescription& constraint : description.constraints) {
    const auto* frames = std::get_if<FrameConstraint>(&constraint.relation);
    if (!frames || !frames->has_target || constraint.baumgarte.position != 0 || constraint.baumgarte.velocity != 0) return {};
    loops.push_back({sideOf(description, frames->frame, frames->placement), sideOf(description, frames->other, frames->other_placement), frames->free,
                     frames->axes});
  }
  if (loops.empty()) return {};
  const VectorR v = exact(state.v), tau = exact(state.tau);
  const auto jacobian = [&](const Place& p) { return jacobianOf(x, loops, p); };
  // The bias is a difference, too: of two steps, each 1e-13, 24 digits are left.
  const Real h(1e-13);
  const auto biasOf = [&](const Place& p, const VectorR& w) { return x.alongMotion(p, w, jacobian, h) * w; };
  // M ddq + nle = torque + J^T lambda with J ddq + bias = 0; redundant rows take the forces of least norm.
  const auto motion = [&](const Place& p, const VectorR& w, const VectorR& torque) {
    const BodyJacobians bodies = x.jacobians(p);
    const MatrixR J = jacobian(p), inverse = x.massMatrix(p, bodies).inverse();
    const VectorR free = inverse * (torque - x.rnea(p, w, VectorR::Zero(x.nv), bodies));
    const VectorR lambda = leastNorm(J * inverse * J.transpose(), -(J * free + biasOf(p, w)));
    return VectorR::stacked({free + inverse * J.transpose() * lambda, lambda});
  };
  const Place at = x.place(exact(state.q));
  const VectorR found = motion(at, v, tau);
  const MatrixR by_q = MatrixR::ofColumns(x.byConfiguration(
      at, [&](const Place& p) { return motion(p, v, tau); }, h));
  const MatrixR by_v = MatrixR::ofColumns(byVector(
      v, [&](const VectorR& w) { return motion(at, w, tau); }, h));
  const Eigen::Index n = x.nv, rows = found.size() - n;
  return {{"loop_J", jacobian(at)},
          {"loop_bias", biasOf(at, v)},
          {"loop_ddq", found.topRows(n)},
          {"loop_lambda", found.bottomRows(rows)},
          {"loop_ddq_dq", by_q.topRows(n)},
          {"loop_ddq_dv", by_v.topRows(n)},
          {"loop_lambda_dq", by_q.bottomRows(rows)},
          {"loop_lambda_dv", by_v.bottomRows(rows)}};
}

}  // namespace dyn::tool
