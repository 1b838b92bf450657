#include "algorithm/external.hpp"
#include "algorithm/inputs.hpp"
#include "kernels/sweep.hpp"

#include <dyn/algorithm/rnea.hpp>

namespace dyn::detail {

namespace {

/// Outward: angular velocity w, angular acceleration and classical acceleration of each body's origin, in its own axes; then the force
/// that moves it. d.a[i] = (classical linear, angular) acceleration, less gravity.
void outward(const CompactImpl& m, DataImpl& d, const Inputs& in, const Force<double>* fext) {
  d.w[0] = {};
  d.a[0] = {-m.gravity, {}};
  kernels::forward(m, d, [&]<class Joint>(const Joint& joint, int i, int iv) {
    const BodyConstants& c = m.constants[static_cast<std::size_t>(i)];
    const int p = m.index[static_cast<std::size_t>(i)].parent;
    SE3<double>& rel = d.rel[i];
    kernels::placeInParent(joint, c.placement, rel);

    const Vec3<double>& wp = d.w[p];
    const Motion<double>& ap = d.a[p];
    const Vec3<double> w_carried = transposeTimes(rel.R, wp);
    const Motion<double> s = joint.times(in.v + iv);
    Motion<double> ds = joint.times(in.a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();

    Vec3<double> w = w_carried, dw = transposeTimes(rel.R, ap.angular);
    Vec3<double> a = transposeTimes(rel.R, ap.linear + cross(ap.angular, rel.p) + cross(wp, cross(wp, rel.p)));
    if constexpr (Joint::has_angular) {
      w += s.angular;
      dw += ds.angular + cross(w_carried, s.angular);
    }
    if constexpr (Joint::has_linear) a += ds.linear + cross(w_carried + w, s.linear);
    d.w[i] = w;
    d.a[i] = {a, dw};

    const Vec3<double> f = c.mass * (a + cross(dw, c.com) + cross(w, cross(w, c.com)));
    const Vec3<double> n = c.rotational * dw + cross(w, c.rotational * w) + cross(c.com, f);
    d.f[i] = {f, n};
    if (fext) d.f[i] -= fext[i];
  });
}

void inward(const CompactImpl& m, DataImpl& d, double* tau) {
  kernels::backward(m, d, [&]<class Joint>(const Joint& joint, int i, int iv) {
    joint.project(d.f[i], tau + iv);
    const int p = m.index[static_cast<std::size_t>(i)].parent;
    if (p > 0) d.f[p] += d.rel[i].act(d.f[i]);
  });
}

const double* inverseDynamics(const CompactImpl& m, DataImpl& d, const Inputs& in, const Force<double>* fext, double* result) {
  evaluateJoints(m, d, in.q, in.v);
  outward(m, d, in, fext);
  double* tau = m.couplings.empty() ? result : d.taux;
  inward(m, d, tau);
  for (std::size_t k = 0; k < m.armature.size(); ++k) tau[k] += m.armature[k] * in.a[k];
  addLosses(m, in.v, tau);
  reduceForces(m, d, tau, result);
  return result;
}

}  // namespace

const double* rnea(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a, const Force<double>* fext, std::size_t count) {
  const Inputs in = readInputs("rnea", model, data, q, &v, &a);
  DataImpl& d = data.impl();
  return inverseDynamics(model.impl(), d, in, readExternalForces("rnea", model.impl(), d, fext, count), d.tau);
}

const double* nonLinearEffects(const CompactModel& model, Data& data, VectorView q, VectorView v) {
  const Inputs in = readInputs("nonLinearEffects", model, data, q, &v, nullptr);
  return inverseDynamics(model.impl(), data.impl(), in, nullptr, data.impl().nle);
}

const double* generalizedGravity(const CompactModel& model, Data& data, VectorView q) {
  const Inputs in = readInputs("generalizedGravity", model, data, q, nullptr, nullptr);
  return inverseDynamics(model.impl(), data.impl(), in, nullptr, data.impl().g);
}

}  // namespace dyn::detail
