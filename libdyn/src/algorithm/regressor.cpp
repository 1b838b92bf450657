// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/recursion/jacobians.hpp"

#include <dyn/algorithm/regressor.hpp>
#include <dyn/spatial/inertial_parameters.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

/// Whether the parameters of joint j's body are counted at joint j. Several of the user's joints can belong to one body.
bool carriesBody(const CompactImpl& m, int j) { return m.index[at(m.body_of_joint[at(j)])].joint == j; }

/// Writes I x for a unit value of each of the six numbers of the rotational inertia I, in the order of the ten parameters.
void writeInertiaTimes(const Vec3<double>& x, Vec3<double>* columns) {
  columns[0] = {x.x, 0, 0};
  columns[1] = {x.y, x.x, 0};
  columns[2] = {0, x.y, 0};
  columns[3] = {x.z, 0, x.x};
  columns[4] = {0, x.z, x.y};
  columns[5] = {0, 0, x.z};
}

/// Writes the force per unit of each of the ten parameters. `origin` is the origin's classical acceleration less gravity.
void forceColumns(const Vec3<double>& origin, const Vec3<double>& w, const Vec3<double>& dw, Force<double>* columns) {
  columns[0] = {origin, {}};
  for (int k = 0; k < 3; ++k) {
    Vec3<double> c;
    c[k] = 1;
    columns[1 + k] = {cross(dw, c) + cross(w, cross(w, c)), cross(c, origin)};
  }
  Vec3<double> inertia[6], momentum[6];
  writeInertiaTimes(dw, inertia);
  writeInertiaTimes(w, momentum);
  for (int k = 0; k < 6; ++k) columns[4 + k] = {{}, inertia[k] + cross(w, momentum[k])};
}

Vec3<double> classical(const Motion<double>& v, const Motion<double>& a) { return a.linear + cross(v.angular, v.linear); }

}  // namespace

void bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration, double* out) {
  Force<double> columns[10];
  forceColumns(classical(velocity, acceleration), velocity.angular, acceleration.angular, columns);
  for (int k = 0; k < 10; ++k)
    for (int r = 0; r < 3; ++r) {
      out[6 * k + r] = columns[k].linear[r];
      out[6 * k + 3 + r] = columns[k].angular[r];
    }
}

const double* jointTorqueRegressor(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a) {
  checkData("computeJointTorqueRegressor", model, data, Need::derivatives);
  forwardKinematics(model, data, q, &v, &a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const std::ptrdiff_t nv = m.nv;
  const bool coupled = !m.couplings.empty();
  std::fill_n(d.regressor, 10 * nv * (model.njoints() - 1), 0.0);
  double* expanded = d.columns;  // one column
  for (int j = 1; j < model.njoints(); ++j) {
    if (!carriesBody(m, j)) continue;
    const PointOnBody point = jointOnBody(model, j);
    const Motion<double> aj = originAccelerationOf(m, point, d);
    const Vec3<double> w = transposeTimes(point.placement.R, d.v[point.body].angular);
    const Mat3<double> R = d.oM[point.body].R * point.placement.R;
    Force<double> columns[10];
    forceColumns(aj.linear - transposeTimes(R, m.gravity), w, aj.angular, columns);
    for (int p = 0; p < 10; ++p) {
      double* column = d.regressor + nv * (10 * (j - 1) + p);
      double* out = coupled ? expanded : column;
      if (coupled) std::fill_n(out, m.nvx, 0.0);
      kernels::Walk<double> walk;
      kernels::walkSupports<double>({m, d}, d, {point.body, point.placement}, nullptr, walk, [&](int i, int k, const Motion<double>& S) {
        out[m.index[at(i)].idx_v + k] = dot(kernels::seen(walk, S), columns[p]);
      });
      if (coupled) reduceForces(m, d, out, column);
    }
  }
  return d.regressor;
}

const double* energyRegressor(const CompactModel& model, Data& data, VectorView q, const VectorView* v) {
  checkData(v ? "computeKineticEnergyRegressor" : "computePotentialEnergyRegressor", model, data, Need::derivatives);
  forwardKinematics(model, data, q, v, nullptr);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  std::fill_n(d.regressor, 10 * (model.njoints() - 1), 0.0);
  for (int j = 1; j < model.njoints(); ++j) {
    if (!carriesBody(m, j)) continue;
    const PointOnBody point = jointOnBody(model, j);
    double* out = d.regressor + 10 * (j - 1);
    if (v == nullptr) {
      const SE3<double> X = d.oM[point.body] * point.placement;
      const Vec3<double> g = transposeTimes(X.R, m.gravity);
      out[0] = -dot(m.gravity, X.p);
      for (int k = 0; k < 3; ++k) out[1 + k] = -g[k];
      continue;
    }
    const Motion<double> vj = point.placement.actInv(d.v[point.body]);
    const Vec3<double>& w = vj.angular;
    const Vec3<double> moment = cross(vj.linear, w);
    out[0] = 0.5 * dot(vj.linear, vj.linear);
    for (int k = 0; k < 3; ++k) out[1 + k] = moment[k];
    Vec3<double> inertia[6];
    writeInertiaTimes(w, inertia);
    for (int k = 0; k < 6; ++k) out[4 + k] = 0.5 * dot(w, inertia[k]);
  }
  return d.regressor;
}

void dynamicParametersOf(const CompactModel& model, double* out) {
  const CompactImpl& m = model.impl();
  std::fill_n(out, 10 * (model.njoints() - 1), 0.0);
  for (int j = 1; j < model.njoints(); ++j) {
    if (!carriesBody(m, j)) continue;
    const BodyConstants<double>& c = m.constants[at(m.body_of_joint[at(j)])];
    const Inertia<double> Y{c.mass, c.com, c.rotational};
    const DynamicParameters pi = toDynamicParameters(Y.transformed(m.user_frame[at(j)].inverse()));
    std::copy(pi.begin(), pi.end(), out + 10 * (j - 1));
  }
}

}  // namespace dyn::detail
