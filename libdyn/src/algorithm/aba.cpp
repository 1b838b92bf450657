#include "algorithm/crba.hpp"
#include "algorithm/external.hpp"
#include "kernels/losses.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/aba.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace dyn::detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// In-place solution of M x = b by square-root-free Cholesky from the leaves to the root (Featherstone 2008, ch. 8); couplings connect
/// distant joints, so M is taken as dense. A pivot of the rounding of its diagonal's size is zero.
void solveDense(const CompactImpl& m, double* M, double* x, double* diagonal) {
  const std::ptrdiff_t n = m.nv;
  for (std::ptrdiff_t k = 0; k < n; ++k) diagonal[k] = M[k * n + k];
  for (std::ptrdiff_t k = n - 1; k >= 0; --k) {
    const double pivot = M[k * n + k];
    if (!(pivot > 8 * std::numeric_limits<double>::epsilon() * diagonal[k]) || !std::isfinite(pivot)) {
      std::size_t joint = m.joints.size() - 1;
      while (m.joints[joint].idx_v > k || m.joints[joint].nv == 0) --joint;
      refuseSingular("aba", m.joints[joint].name);
    }
    for (std::ptrdiff_t i = 0; i < k; ++i) {
      const double l = M[k * n + i] / pivot;
      if (l == 0) continue;
      for (std::ptrdiff_t j = 0; j <= i; ++j) M[i * n + j] -= l * M[k * n + j];
      x[i] -= l * x[k];
    }
  }
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    double sum = x[k];
    for (std::ptrdiff_t i = 0; i < k; ++i) sum -= M[k * n + i] * x[i];
    x[k] = sum / M[k * n + k];
  }
}

}  // namespace

const double* aba(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext, std::size_t count) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (!m.couplings.empty()) {
    checkData("aba of a model with coupled joints", model, data, Need::mass_matrix);
    checkSize("aba", "tau", tau, m.nv);
    const VectorView zero{d.zero, m.nv};
    const double* bias = rnea(model, data, q, v, zero, fext, count);
    for (int k = 0; k < m.nv; ++k) d.ddq[k] = tau.data[k] - bias[k];
    massMatrix(m, d);
    solveDense(m, d.M, d.ddq, d.ax);
    return d.ddq;
  }
  const Inputs in = readInputs("aba", model, data, q, &v, nullptr);
  checkSize("aba", "tau", tau, m.nv);
  const Force<double>* external = readExternalForces("aba", m, d, fext, count);
  const double* effective = tau.data;
  if (!m.damping.empty() || !m.friction.empty()) {
    std::copy(tau.data, tau.data + m.nv, d.tau);
    kernels::addLosses(m, -1.0, in.v, d.tau);
    effective = d.tau;
  }
  int body = 0;
  if (kernels::useStrips(m) && external == nullptr) {
    if (!kernels::active().strips.aba(m, d.strips.data(), in.q, in.v, effective, d.ddq, body)) checkConfiguration("q", m, in.q);
  } else {
    evaluateJoints(m, d, in.q, in.v);
    kernels::active().single.aba(m, d, in.v, effective, external, d.ddq);
    body = d.failed[0];
  }
  if (body != 0) refuseSingular("aba", m.joints[at(m.index[at(body)].joint)].name);
  return d.ddq;
}

}  // namespace dyn::detail
