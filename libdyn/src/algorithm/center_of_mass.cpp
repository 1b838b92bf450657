// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/sums.hpp"
#include "at.hpp"
#include "kernels/order/sweep.hpp"
#include "kernels/recursion/body_sums.hpp"

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/kinematics.hpp>

namespace dyn::detail {

CenterOfMass sumCenterOfMass(const CompactImpl& m, DataImpl& d, bool v, bool a) {
  const kernels::MassMotion<double> sum = kernels::centerOfMass<double>(kernels::Bodies<double>{m, d}, d, v, a);
  return {sum.position, sum.velocity, sum.acceleration};
}

CenterOfMass centerOfMass(const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a) {
  forwardKinematics(model, data, q, v, a);
  return sumCenterOfMass(model.impl(), data.impl(), v != nullptr, a != nullptr);
}

const double* jacobianCenterOfMass(const CompactModel& model, Data& data, VectorView q) {
  forwardKinematics(model, data, q, nullptr, nullptr);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  for (int i = 1; i < m.bodies(); ++i) {
    d.mass[i] = m.constants[at(i)].mass;
    d.h[i] = d.oM[i].R * m.constants[at(i)].h;
  }
  double* J = m.couplings.empty() ? d.Jcom : d.columns;
  const double per_mass = 1 / m.mass;
  kernels::Bodies<double>{m, d}.backward(kernels::passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    // m and h are the subtree's mass and first moment about the joint's origin, world axes. Unit rate along S gives it momentum m S_lin + S_ang x h.
    for (int k = 0; k < kernels::nvOf(joint); ++k) {
      const Motion<double> S = joint.columnIn(d.oM[i].R, k);
      Vec3<double> moved;
      if constexpr (Joint::has_linear) moved += d.mass[i] * S.linear;
      if constexpr (Joint::has_angular) moved += cross(S.angular, d.h[i]);
      for (int r = 0; r < 3; ++r) J[3 * (iv + k) + r] = per_mass * moved[r];
    }
    const int p = m.index[at(i)].parent;
    if (p == 0) return;
    d.h[p] += d.h[i] + d.mass[i] * (d.oM[p].R * d.rel[i].p);
    d.mass[p] += d.mass[i];
  });
  if (!m.couplings.empty()) {
    const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
    dependents.fold(3, J);
    dependents.keep(3, J, d.Jcom);
  }
  return d.Jcom;
}

double sumKineticEnergy(const CompactImpl& m, DataImpl& d, const double* v) {
  return kernels::kineticEnergy<double>(kernels::Bodies<double>{m, d}, d, v);
}

double kineticEnergy(const CompactModel& model, Data& data, VectorView q, VectorView v) {
  forwardKinematics(model, data, q, &v, nullptr);
  return sumKineticEnergy(model.impl(), data.impl(), model.impl().couplings.empty() ? v.data : data.impl().vx);
}

double sumPotentialEnergy(const CompactImpl& m, DataImpl& d) { return kernels::potentialEnergy<double>(kernels::Bodies<double>{m, d}, d); }

double potentialEnergy(const CompactModel& model, Data& data, VectorView q) {
  forwardKinematics(model, data, q, nullptr, nullptr);
  return sumPotentialEnergy(model.impl(), data.impl());
}

}  // namespace dyn::detail
