// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/sums.hpp"
#include "at.hpp"
#include "kernels/order/sweep.hpp"
#include "kernels/recursion/kinematics.hpp"

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/kinematics.hpp>

#include <cmath>

namespace dyn::detail {

namespace {

/// A sum that also adds up its rounding errors (Neumaier 1974), because the energies of bodies above and below the origin may cancel.
class CompensatedSum {
 public:
  void add(double x) {
    const double next = sum_ + x;
    lost_ += std::fabs(sum_) >= std::fabs(x) ? (sum_ - next) + x : (x - next) + sum_;
    sum_ = next;
  }
  double total() const { return sum_ + lost_; }

 private:
  double sum_ = 0, lost_ = 0;
};
}  // namespace

CenterOfMass sumCenterOfMass(const CompactImpl& m, const DataImpl& d, bool v, bool a) {
  CenterOfMass sum;
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyConstants<double>& c = m.constants[at(i)];
    const double share = c.mass / m.mass;
    sum.position += share * d.oM[i].act(c.com);
    if (!v) continue;
    const Vec3<double> local = d.v[i].linear + cross(d.v[i].angular, c.com);
    sum.velocity += share * (d.oM[i].R * local);
    if (!a) continue;
    const int p = m.index[at(i)].parent;
    const Vec3<double> parent = p == 0 ? Vec3<double>{} : d.origin[p];
    d.origin[i] = transposeTimes(d.rel[i].R, parent + kernels::beyondOrigin(d.a[p].angular, d.v[p].angular, d.rel[i].p)) + d.sliding[i];
    sum.acceleration += share * (d.oM[i].R * (d.origin[i] + kernels::beyondOrigin(d.a[i].angular, d.v[i].angular, c.com)));
  }
  return sum;
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

double sumKineticEnergy(const CompactImpl& m, const DataImpl& d, const double* v) {
  double twice = 0;
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyConstants<double>& c = m.constants[at(i)];
    const Vec3<double> vc = d.v[i].linear + cross(d.v[i].angular, c.com);
    twice += c.mass * dot(vc, vc) + dot(d.v[i].angular, c.rotational * d.v[i].angular);
  }
  for (std::size_t k = 0; k < m.armature.size(); ++k) twice += m.armature[k] * v[k] * v[k];
  return 0.5 * twice;
}

double kineticEnergy(const CompactModel& model, Data& data, VectorView q, VectorView v) {
  forwardKinematics(model, data, q, &v, nullptr);
  return sumKineticEnergy(model.impl(), data.impl(), model.impl().couplings.empty() ? v.data : data.impl().vx);
}

double sumPotentialEnergy(const CompactImpl& m, const DataImpl& d) {
  CompensatedSum energy;
  for (int i = 1; i < m.bodies(); ++i) energy.add(-m.constants[at(i)].mass * dot(m.gravity, d.oM[i].act(m.constants[at(i)].com)));
  return energy.total();
}

double potentialEnergy(const CompactModel& model, Data& data, VectorView q) {
  forwardKinematics(model, data, q, nullptr, nullptr);
  return sumPotentialEnergy(model.impl(), data.impl());
}

}  // namespace dyn::detail
