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

/// Writes x . I y for a unit value of each of the six numbers of the rotational inertia I, in the order of the ten parameters.
void inertiaProducts(const Vec3<double>& x, const Vec3<double>& y, double* out) {
  out[0] = x.x * y.x;
  out[1] = x.x * y.y + x.y * y.x;
  out[2] = x.y * y.y;
  out[3] = x.x * y.z + x.z * y.x;
  out[4] = x.y * y.z + x.z * y.y;
  out[5] = x.z * y.z;
}

/// The forces that give a body with a unit value of one of the ten parameters, and zero for the others, its motion:
///   m        linear o, with the origin's classical acceleration o less gravity
///   m c      linear A c, angular c x o, with A = dw x + w x w x
///   I        angular I dw + w x I w
class UnitForces {
 public:
  UnitForces(const Vec3<double>& origin, const Vec3<double>& w, const Vec3<double>& dw) : o_(origin), w_(w), dw_(dw) {
    const double ww = dot(w, w);
    A_ = {{w.x * w.x - ww, w.x * w.y - dw.z, w.x * w.z + dw.y,  //
           w.x * w.y + dw.z, w.y * w.y - ww, w.y * w.z - dw.x,  //
           w.x * w.z - dw.y, w.y * w.z + dw.x, w.z * w.z - ww}};
  }

  /// Writes the power of each force along the motion s, `stride` numbers apart.
  void along(const Motion<double>& s, double* out, std::ptrdiff_t stride) const {
    out[0] = dot(s.linear, o_);
    const Vec3<double> c = transposeTimes(A_, s.linear) + cross(o_, s.angular);
    for (int k = 0; k < 3; ++k) out[(1 + k) * stride] = c[k];
    double spin[6], gyroscopic[6];
    inertiaProducts(s.angular, dw_, spin);
    inertiaProducts(cross(s.angular, w_), w_, gyroscopic);
    for (int k = 0; k < 6; ++k) out[(4 + k) * stride] = spin[k] + gyroscopic[k];
  }

 private:
  Vec3<double> o_, w_, dw_;
  Mat3<double> A_;
};

/// The motion of each degree of freedom in world axes, about the origin of the root of its tree, and each body's origin from there. The base's
/// distance from the world's origin does not enter.
struct TreeMotions {
  Motion<double>* column;  ///< by degree of freedom
  Vec3<double>* origin;    ///< by body

  TreeMotions(const CompactImpl& m, DataImpl& d) : column(reinterpret_cast<Motion<double>*>(d.Ag)), origin(reinterpret_cast<Vec3<double>*>(d.dAg)) {
    const kernels::Bodies<double> bodies{m, d};
    bodies.forward(kernels::passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
      const Mat3<double>& R = d.oM[i].R;
      origin[i] = bodies.isRoot(i) ? Vec3<double>{} : origin[bodies.parentOf(i)] + d.oM[bodies.parentOf(i)].R * d.rel[i].p;
      for (int k = 0; k < kernels::nvOf(joint); ++k) {
        const Motion<double> s = joint.columnIn(R, k);
        column[iv + k] = {s.linear + cross(origin[i], s.angular), s.angular};
      }
    });
  }
};

Vec3<double> classical(const Motion<double>& v, const Motion<double>& a) { return a.linear + cross(v.angular, v.linear); }

}  // namespace

void bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration, double* out) {
  const UnitForces forces(classical(velocity, acceleration), velocity.angular, acceleration.angular);
  for (int r = 0; r < 6; ++r) {
    Motion<double> unit{};
    (r < 3 ? unit.linear : unit.angular)[r % 3] = 1;
    forces.along(unit, out + r, 6);
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
  const TreeMotions motions(m, d);
  for (int j = 1; j < model.njoints(); ++j) {
    if (!carriesBody(m, j)) continue;
    const PointOnBody point = jointOnBody(model, j);
    const Mat3<double> R = d.oM[point.body].R * point.placement.R;
    const Motion<double> aj = originAccelerationOf(m, point, d);
    const UnitForces forces(aj.linear - transposeTimes(R, m.gravity), transposeTimes(point.placement.R, d.v[point.body].angular), aj.angular);
    const Vec3<double> origin = motions.origin[point.body] + d.oM[point.body].R * point.placement.p;
    // Joints that follow others have rows of their own until reduceForces() adds them to those of their masters.
    double* const block = d.regressor + 10 * nv * (j - 1);
    double* const out = coupled ? d.columns : block;
    const std::ptrdiff_t rows = coupled ? m.nvx : nv;
    if (coupled) std::fill_n(out, 10 * rows, 0.0);
    const BodyIndex& body = m.index[at(point.body)];
    // The degrees of freedom of the path, in contiguous runs.
    for (int last = body.idx_v + m.batches[at(body.batch)].nv - 1, first; last >= 0; last = m.dof_parent[at(first)]) {
      first = m.dof_segment[at(last)];
      for (int k = first; k <= last; ++k) {
        const Motion<double>& S = motions.column[k];
        forces.along({transposeTimes(R, S.linear + cross(S.angular, origin)), transposeTimes(R, S.angular)}, out + k, rows);
      }
    }
    for (int p = 0; coupled && p < 10; ++p) reduceForces(m, d, out + p * rows, block + p * nv);
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
    inertiaProducts(w, w, out + 4);
    for (int k = 0; k < 6; ++k) out[4 + k] *= 0.5;
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
