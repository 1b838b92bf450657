// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/body/unit_forces.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/regressor.hpp>
#include <dyn/spatial/inertial_parameters.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

/// Writes x . I y for a unit value of each of the six numbers of the rotational inertia I, in the order of the ten parameters.
void inertiaProducts(const Vec3<double>& x, const Vec3<double>& y, double* out) {
  out[0] = x.x * y.x;
  out[1] = x.x * y.y + x.y * y.x;
  out[2] = x.y * y.y;
  out[3] = x.x * y.z + x.z * y.x;
  out[4] = x.y * y.z + x.z * y.y;
  out[5] = x.z * y.z;
}

Vec3<double> classical(const Motion<double>& v, const Motion<double>& a) { return a.linear + cross(v.angular, v.linear); }

}  // namespace

void bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration, double* out) {
  const kernels::UnitForces forces(classical(velocity, acceleration), velocity.angular, acceleration.angular);
  for (int r = 0; r < 6; ++r) {
    Motion<double> unit{};
    (r < 3 ? unit.linear : unit.angular)[r % 3] = 1;
    forces.along(unit, [&](int k, double power) { out[6 * k + r] = power; });
  }
}

const double* jointTorqueRegressor(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a) {
  checkData("computeJointTorqueRegressor", model, data, Need::derivatives);
  forwardKinematics(model, data, q, &v, &a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  kernels::active().single.torqueRegressor(m, d, d.torque_regressor, d.expanded_regressor);
  if (m.couplings.empty()) return d.regressor;
  // Joints that follow others have rows of their own, which are added to those of their masters.
  for (std::ptrdiff_t k = 0; k < 10 * (model.njoints() - 1); ++k) {
    std::copy_n(d.expanded_regressor + k * m.nvx, m.nvx, d.taux);
    reduceForces(m, d, d.taux, d.regressor + k * m.nv);
  }
  return d.regressor;
}

const double* energyRegressor(const CompactModel& model, Data& data, VectorView q, const VectorView* v) {
  checkData(v ? "computeKineticEnergyRegressor" : "computePotentialEnergyRegressor", model, data, Need::derivatives);
  forwardKinematics(model, data, q, v, nullptr);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  for (int j = 1; j < model.njoints(); ++j) {
    if (!kernels::carriesBody(m, j)) continue;
    const PointOnBody point = jointOnBody(model, j);
    double* out = d.energy_regressor + 10 * (j - 1);
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
    inertiaProducts(w, w, out + 4);
    for (int k = 0; k < 6; ++k) out[4 + k] *= 0.5;
  }
  return d.energy_regressor;
}

void dynamicParametersOf(const CompactModel& model, double* out) {
  const CompactImpl& m = model.impl();
  std::fill_n(out, 10 * (model.njoints() - 1), 0.0);
  for (int j = 1; j < model.njoints(); ++j) {
    if (!kernels::carriesBody(m, j)) continue;
    const BodyConstants<double>& c = m.constants[at(m.body_of_joint[at(j)])];
    const Inertia<double> Y{c.mass, c.com, c.rotational};
    const DynamicParameters pi = toDynamicParameters(Y.transformed(m.user_frame[at(j)].inverse()));
    std::copy(pi.begin(), pi.end(), out + 10 * (j - 1));
  }
}

}  // namespace dyn::detail
