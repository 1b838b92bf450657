// SPDX-License-Identifier: BSD-2-Clause
#include "exact_quantities.hpp"

namespace dyn::tool {

namespace {

VectorR six(const Vec& linear, const Vec& angular) { return VectorR::stacked({linear, angular}); }

/// Sums over the moving bodies, in world axes.
struct Sums {
  Real mass = 0, kinetic = 0, potential = 0;
  Vec com = Vec::Zero(3), velocity = Vec::Zero(3), acceleration = Vec::Zero(3);  ///< of the centre of mass
  VectorR momentum = VectorR::Zero(6), rate = VectorR::Zero(6);                  ///< about the centre of mass; of the momentum, without gravity
};
Sums sumsOf(const ExactBodies& x, const Place& at, const VectorR& v, const VectorR& a) {
  const std::vector<Series> moved = x.motions(at, v, a);
  Sums out;
  const auto each = [&](auto&& use) {
    for (std::size_t i = 1; i < x.bodies.size(); ++i) {
      if (!x.bodies[i].moves) continue;
      std::array<Vec, 3> c;
      for (std::size_t k = 0; k < 3; ++k) c[k] = moved[i].p[k] + moved[i].R[k] * x.bodies[i].com;
      use(x.bodies[i], moved[i], c);
    }
  };
  each([&](const ExactBody& body, const Series& pose, const std::array<Vec, 3>& c) {
    out.mass += body.mass;
    out.com += body.mass * c[0];
    out.velocity += body.mass * c[1];
    out.acceleration += body.mass * c[2];
    const Vec w = pose.R[0].transpose() * pose.omega();
    out.kinetic += (body.mass * c[1].squaredNorm() + w.dot(body.inertia * w)) / Real(2);
    out.potential -= body.mass * x.gravity.dot(c[0]);
  });
  out.com /= out.mass;
  each([&](const ExactBody& body, const Series& pose, const std::array<Vec, 3>& c) {
    const Vec arm = c[0] - out.com, spin = pose.R[0] * body.inertia * pose.R[0].transpose() * pose.omega();
    out.momentum += six(body.mass * c[1], body.mass * (cross(arm) * c[1]) + spin);
    out.rate += six(body.mass * c[2], body.mass * (cross(arm) * c[2]) + momentOf(body, pose));
  });
  out.velocity /= out.mass;
  out.acceleration /= out.mass;
  return out;
}

/// Ag: the momenta for unit velocities.
MatrixR momentumMap(const ExactBodies& x, const Place& at) {
  std::vector<VectorR> columns;
  for (int k = 0; k < x.nv; ++k) columns.push_back(sumsOf(x, at, VectorR::Unit(x.nv, k), VectorR::Zero(x.nv)).momentum);
  return MatrixR::ofColumns(columns);
}

/// The time derivatives of the coordinates, for unit velocities.
MatrixR ratesAt(const ExactBodies& x, const Place& at) {
  MatrixR out(at.q.size(), x.nv);
  for (int k = 0; k < x.nv; ++k) {
    const std::vector<TimeSeries> moving = x.coordinates(at.q, VectorR::Unit(x.nv, k), VectorR::Zero(x.nv));
    for (Eigen::Index i = 0; i < at.q.size(); ++i) out(i, k) = moving[static_cast<std::size_t>(i)].c[1];
  }
  return out;
}

/// The Coriolis matrix of the Levi-Civita connection of M, by Koszul's formula for the velocity fields E_k, along which unit velocities move:
/// 2 C_kj = sum_i v_i (dM_kj/dE_i + dM_ki/dE_j - dM_ij/dE_k + [E_i,E_j].E_k - [E_i,E_k].E_j - [E_j,E_k].E_i), with M as scalar product. Where v is
/// dq/dt, the brackets are zero and the rest are Christoffel symbols.
MatrixR coriolisOf(const ExactBodies& x, const Place& at, const VectorR& v) {
  const auto massMatrix = [&](const Place& p) { return x.massMatrix(p, x.jacobians(p)); };
  const MatrixR B = ratesAt(x, at), lower = massMatrix(at) * (B.transpose() * B).inverse() * B.transpose();
  const std::vector<MatrixR> dM = x.byConfiguration(at, massMatrix), dB = x.byConfiguration(at, [&](const Place& p) { return ratesAt(x, p); });
  const auto index = [](int k) { return static_cast<std::size_t>(k); };
  // Column j of brackets[i]: scalar products of [E_i, E_j] with all fields.
  std::vector<MatrixR> brackets(index(x.nv), MatrixR(x.nv, x.nv));
  for (int i = 0; i < x.nv; ++i)
    for (int j = 0; j < x.nv; ++j) brackets[index(i)].col(j) = lower * (dB[index(i)].col(j) - dB[index(j)].col(i));
  MatrixR C = MatrixR::Zero(x.nv, x.nv);
  for (int i = 0; i < x.nv; ++i)
    for (int j = 0; j < x.nv; ++j)
      for (int k = 0; k < x.nv; ++k)
        C(k, j) += v[i] / Real(2) *
                   (dM[index(i)](k, j) + dM[index(j)](k, i) - dM[index(k)](i, j) + brackets[index(i)](k, j) - brackets[index(i)](j, k) -
                    brackets[index(j)](i, k));
  return C;
}

/// The local velocity (R^T p', R^T w) of a pose and its time derivative.
std::pair<VectorR, VectorR> localMotion(const Series& X) {
  const Mat Rt = X.R[0].transpose();
  return {six(Rt * X.p[1], Rt * X.omega()), six(Rt * (X.p[2] - cross(X.omega()) * X.p[1]), Rt * X.alpha())};
}

}  // namespace

Quantities dynamicsOf(const ExactBodies& x, const State& state, bool derivatives) {
  const int n = x.nv;
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a), tau = exact(state.tau), still = VectorR::Zero(n);
  const BodyJacobians J = x.jacobians(at);
  const MatrixR M = x.massMatrix(at, J);
  const VectorR nle = x.rnea(at, v, still, J);
  const MatrixR Minv = M.inverse();
  const VectorR ddq = Minv * (tau - nle);

  Quantities out;
  out["rnea"] = x.rnea(at, v, a, J);
  out["nle"] = nle;
  out["gravity"] = x.rnea(at, still, still, J);
  out["M"] = M;
  out["aba"] = ddq;
  const std::vector<double> scale = x.scale(at, v, a), moved = x.scale(at, v, ddq);
  out["rnea_scale"] = exact(Eigen::Map<const Eigen::VectorXd>(scale.data(), n));
  const VectorR torques = exact(Eigen::Map<const Eigen::VectorXd>(moved.data(), n) + state.tau.cwiseAbs());
  out["aba_scale"] = Minv.absolute() * torques;
  out["Minv"] = Minv;
  if (!derivatives) return out;
  const std::vector<VectorR> by_q = x.byConfiguration(at, [&](const Place& p) {
    const BodyJacobians there = x.jacobians(p);
    return VectorR::stacked({x.rnea(p, v, a, there), x.rnea(p, v, ddq, there)});
  });
  const MatrixR both = MatrixR::ofColumns(by_q), by_v = MatrixR::ofColumns(byVector(v, [&](const VectorR& w) { return x.rnea(at, w, a, J); }));
  out["dtau_dq"] = both.topRows(n);
  out["dtau_dv"] = by_v;
  // These follow by differentiating M ddq + nle = tau.
  out["ddq_dq"] = -Minv * both.bottomRows(n);
  out["ddq_dv"] = -Minv * by_v;
  return out;
}

Quantities jointsOf(const ExactBodies& x, const State& state) {
  const int n = x.nv;
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a), still = VectorR::Zero(n);
  const std::vector<Series> poses = x.motions(at, v, a);
  const BodyJacobians J = x.jacobians(at, true);
  Quantities out;
  // Poses with rotation matrices row after row, and the spatial velocity in the world for unit velocities.
  const auto joints = static_cast<Eigen::Index>(x.carried.size());
  MatrixR& oMi = out["oMi"] = MatrixR::Zero(joints - 1, 12);
  MatrixR columns = MatrixR::Zero(6, n);
  VectorR forces(6 * joints), torques = x.rnea(at, still, still);
  for (Eigen::Index j = 0; j < joints; ++j) {
    // Any forces do; these are whole numbers from -5 to 5.
    for (int c = 0; c < 6; ++c) forces[6 * j + c] = Real(static_cast<double>((7 * j + 3 * c) % 11 - 5));
    if (j == 0) continue;
    const std::size_t i = x.carried[static_cast<std::size_t>(j)];
    const Series& X = poses[i];
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) oMi(j - 1, 3 * r + c) = X.R[0](r, c);
    oMi.block(j - 1, 9, 1, 3) = X.p[0].transpose();
    for (int d = 0; d < x.bodies[i].freedom(); ++d) {
      const int k = x.bodies[i].v + d;
      columns.col(k) = six(J.linear[i].col(k) + cross(X.p[0]) * J.angular[i].col(k), J.angular[i].col(k));
    }
    torques -=
        J.linear[i].transpose() * (X.R[0] * forces.middleRows(6 * j, 3)) + J.angular[i].transpose() * (X.R[0] * forces.middleRows(6 * j + 3, 3));
  }
  if (!x.follows()) out["J"] = columns;  // computeJointJacobians refuses models with dependent joints
  out["fext"] = forces;
  out["static_torque"] = torques;
  out["coriolis_matrix"] = coriolisOf(x, at, v);
  return out;
}

Quantities centroidalOf(const ExactBodies& x, const State& state) {
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a);
  Quantities out;
  const Sums sums = sumsOf(x, at, v, a);
  const auto put = [&](const char* key, const VectorR& value) { out[key] = value; };
  put("kinetic_energy", VectorR::Constant(1, sums.kinetic));
  put("potential_energy", VectorR::Constant(1, sums.potential));
  put("com", sums.com);
  put("vcom", sums.velocity);
  put("acom", sums.acceleration);
  put("hg", sums.momentum);
  put("dhg", sums.rate);
  const MatrixR Ag = out["Ag"] = momentumMap(x, at);
  out["dAg"] = x.alongMotion(at, v, [&](const Place& p) { return momentumMap(x, p); });
  out["Jcom"] = Ag.topRows(3) / sums.mass;
  const auto motion = [&](const Sums& s) { return VectorR::stacked({s.momentum, s.rate}); };
  const MatrixR by_q = MatrixR::ofColumns(x.byConfiguration(at, [&](const Place& p) { return motion(sumsOf(x, p, v, a)); }));
  const MatrixR by_v = MatrixR::ofColumns(byVector(v, [&](const VectorR& w) { return motion(sumsOf(x, at, w, a)); }));
  out["dhg_dq"] = by_q.topRows(6);
  out["dhgdot_dq"] = by_q.bottomRows(6);
  out["dhgdot_dv"] = by_v.bottomRows(6);
  out["vcom_dq"] = by_q.topRows(3) / sums.mass;
  out["acom_dq"] = by_q.middleRows(6, 3) / sums.mass;
  out["acom_dv"] = by_v.middleRows(6, 3) / sums.mass;
  return out;
}

Quantities frameOf(const ExactBodies& x, const State& state, std::size_t body) {
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a);
  /// Jacobians in LOCAL, LOCAL_WORLD_ALIGNED and WORLD, one below the other.
  const auto jacobians = [&](const Place& p) {
    MatrixR out(18, x.nv);
    for (int k = 0; k < x.nv; ++k) {
      const Series X = x.motions(p, VectorR::Unit(x.nv, k), VectorR::Zero(x.nv))[body];
      out.col(k) = VectorR::stacked({localMotion(X).first, X.p[1], X.omega(), X.p[1] + cross(X.p[0]) * X.omega(), X.omega()});
    }
    return out;
  };
  const auto motion = [&](const Place& p, const VectorR& w) {
    const auto [velocity, acceleration] = localMotion(x.motions(p, w, a)[body]);
    return VectorR::stacked({velocity, acceleration});
  };
  const Series X = x.motions(at, v, a)[body];
  const MatrixR J = jacobians(at), dJ = x.alongMotion(at, v, jacobians);
  const MatrixR by_q = MatrixR::ofColumns(x.byConfiguration(at, [&](const Place& p) { return motion(p, v); }));
  const MatrixR by_v = MatrixR::ofColumns(byVector(v, [&](const VectorR& w) { return motion(at, w); }));
  return {{"J_local", J.topRows(6)},
          {"J_lwa", J.middleRows(6, 6)},
          {"J_world", J.bottomRows(6)},
          {"dJ_local", dJ.topRows(6)},
          {"dJ_lwa", dJ.middleRows(6, 6)},
          {"dJ_world", dJ.bottomRows(6)},
          {"vel_local", motion(at, v).topRows(6)},
          {"acc_local_spatial", motion(at, v).bottomRows(6)},
          {"acc_lwa_classical", six(X.p[2], X.alpha())},
          {"v_dq", by_q.topRows(6)},
          {"a_dq", by_q.bottomRows(6)},
          {"a_dv", by_v.bottomRows(6)}};
}

Quantities secondDerivativesOf(const ExactBodies& x, const State& state) {
  // Two steps divide the rounding error by 1e-26, so 24 digits are right.
  const Real h(1e-13);
  const int n = x.nv;
  const Place at = x.place(exact(state.q));
  const VectorR v = exact(state.v), a = exact(state.a);
  const auto by_q = [&](const Place& p, const VectorR& w) {
    return MatrixR::ofColumns(x.byConfiguration(
        p, [&](const Place& q) { return x.rnea(q, w, a); }, h));
  };
  // Torques are quadratic in velocities, so differences of any step are exact.
  const auto by_v = [&](const Place& p, const VectorR& w) {
    const BodyJacobians J = x.jacobians(p);
    std::vector<VectorR> columns;
    for (int k = 0; k < n; ++k) columns.push_back((x.rnea(p, w + VectorR::Unit(n, k), a, J) - x.rnea(p, w - VectorR::Unit(n, k), a, J)) / Real(2));
    return MatrixR::ofColumns(columns);
  };
  const auto below = [&](const std::vector<MatrixR>& matrices) {
    MatrixR out(n * n, n);
    for (int k = 0; k < n; ++k) out.middleRows(n * k, n) = matrices[static_cast<std::size_t>(k)];
    return out;
  };
  std::vector<MatrixR> vv;
  for (int k = 0; k < n; ++k) vv.push_back((by_v(at, v + VectorR::Unit(n, k)) - by_v(at, v - VectorR::Unit(n, k))) / Real(2));
  return {{"d2tau_dqdq", below(x.byConfiguration(
                             at, [&](const Place& p) { return by_q(p, v); }, h))},
          {"d2tau_dqdv", below(x.byConfiguration(
                             at, [&](const Place& p) { return by_v(p, v); }, h))},
          {"d2tau_dvdv", below(vv)},
          {"d2tau_dadq", below(x.byConfiguration(at, [&](const Place& p) { return x.massMatrix(p, x.jacobians(p)); }))}};
}

}  // namespace dyn::tool
