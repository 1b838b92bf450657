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
      std::fill_n(out + 4, 6, 0.0);
      continue;
    }
    const Motion<double> vj = point.placement.actInv(d.v[point.body]);
    const Vec3<double>& w = vj.angular;
    const Vec3<double> moment = cross(vj.linear, w);
    out[0] = 0.5 * dot(vj.linear, vj.linear);
    for (int k = 0; k < 3; ++k) out[1 + k] = moment[k];
    // w . I w / 2, in the order of the ten parameters
    out[4] = 0.5 * w.x * w.x;
    out[5] = w.x * w.y;
    out[6] = 0.5 * w.y * w.y;
    out[7] = w.x * w.z;
    out[8] = w.y * w.z;
    out[9] = 0.5 * w.z * w.z;
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
