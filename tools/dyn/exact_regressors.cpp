// SPDX-License-Identifier: BSD-2-Clause
// The moments of a body's mass are those of order zero, one and two: m, m c and Sigma = sum m s s^T = tr(I) / 2 - I, with s and I about the joint's
// origin. A point at s moves as p(t) + R(t) s, so work and energies are sums over the moments, and no angular velocity is needed.
#include "exact_quantities.hpp"

namespace dyn::tool {

namespace {

/// Moments of the dynamic parameter c of (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) = 1, all others 0.
struct Moments {
  Real mass = 0;
  Vec first = Vec::Zero(3);
  Mat second = Mat::Zero(3, 3);
};
Moments momentsOf(int c) {
  constexpr int rows[] = {0, 0, 1, 0, 1, 2}, columns[] = {0, 1, 1, 2, 2, 2};
  Moments out;
  if (c == 0) out.mass = Real(1);
  if (c >= 1 && c < 4) out.first[c - 1] = Real(1);
  if (c < 4) return out;
  const int i = rows[c - 4], j = columns[c - 4];
  if (i == j) out.second = Mat::Identity(3) / Real(2);
  out.second(i, j) -= Real(1);
  if (i != j) out.second(j, i) -= Real(1);
  return out;
}

/// The sum over a body's mass of (p + R s) . (q + Q s).
Real product(const Vec& p, const Mat& R, const Vec& q, const Mat& Q, const Moments& body) {
  return body.mass * p.dot(q) + p.dot(Q * body.first) + q.dot(R * body.first) + (R.transpose() * Q * body.second).trace();
}

}  // namespace

Quantities regressorsOf(const ExactBodies& x, const State& state) {
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a), still = VectorR::Zero(x.nv);
  const auto columns = 10 * static_cast<Eigen::Index>(x.carried.size() - 1);
  MatrixR torque(x.nv, columns), kinetic(1, columns), potential(1, columns);
  const std::vector<Series> moved = x.motions(at, v, a);
  std::vector<std::vector<Series>> units;
  for (int k = 0; k < x.nv; ++k) units.push_back(x.motions(at, VectorR::Unit(x.nv, k), still));
  for (Eigen::Index c = 0; c < columns; ++c) {
    const std::size_t i = x.carried[static_cast<std::size_t>(c / 10 + 1)];
    const Series& X = moved[i];
    const Moments body = momentsOf(static_cast<int>(c % 10));
    for (int k = 0; k < x.nv; ++k) {
      const Series& unit = units[static_cast<std::size_t>(k)][i];
      torque(k, c) = product(unit.p[1], unit.R[1], X.p[2] - x.gravity, X.R[2], body);
    }
    kinetic(0, c) = product(X.p[1], X.R[1], X.p[1], X.R[1], body) / Real(2);
    potential(0, c) = -x.gravity.dot(body.mass * X.p[0] + X.R[0] * body.first);
  }
  return {{"torque_regressor", torque}, {"kinetic_energy_regressor", kinetic}, {"potential_energy_regressor", potential}};
}

}  // namespace dyn::tool
