#include "algorithm/crba.hpp"

#include "kernels/aligned.hpp"

#include <dyn/algorithm/crba.hpp>

#include <algorithm>

namespace dyn {

namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// Rotational inertia about a point at distance r from the old origin (old origin = new origin + r), first moment h, mass m.
Sym3<double> shiftedInertia(const Sym3<double>& I, double mass, const Vec3<double>& h, const Vec3<double>& r) {
  const Vec3<double> k = h + 0.5 * mass * r;  // I + [..] = I - (h r^T + r h^T + m r r^T) + trace part, symmetric in h + m r / 2
  const double t = 2 * dot(k, r);
  return I + Sym3<double>{t - 2 * k.x * r.x, -(k.x * r.y + r.x * k.y), -(k.x * r.z + r.x * k.z),
                          t - 2 * k.y * r.y, -(k.y * r.z + r.y * k.z), t - 2 * k.z * r.z};
}

/// M of the expanded coordinates, column-major n x n, lower triangle's blocks mirrored.
void expandedMassMatrix(const CompactImpl& m, DataImpl& d, double* M) {
  const int n = m.nvx;
  std::fill(M, M + static_cast<std::ptrdiff_t>(n) * n, 0.0);
  kernels::forward(m, d, [&]<class Joint>(const Joint& joint, int i, int iv) {
    const BodyConstants& c = m.constants[at(i)];
    kernels::placeAligned(joint, c.placement, i, m.index[at(i)], d);
    const Mat3<double>& R = d.R[i];
    d.mass[i] = c.mass;
    d.h[i] = R * c.h;
    d.Io[i] = congruence(R, c.origin);
    for (int k = 0; k < Joint::nv; ++k) d.dof[iv + k].S = kernels::alignedColumn(joint, k, R);
  });
  kernels::backward(m, d, [&]<class Joint>(const Joint&, int i, int iv) {
    const int p = m.index[at(i)].parent;
    Force<double> F[Joint::nv];
    for (int k = 0; k < Joint::nv; ++k) {
      const Motion<double>& S = d.dof[iv + k].S;
      F[k] = {d.mass[i] * S.linear + cross(S.angular, d.h[i]), d.Io[i] * S.angular + cross(d.h[i], S.linear)};
    }
    for (int k = 0; k < Joint::nv; ++k)
      for (int l = 0; l <= k; ++l) {
        const double x = dot(d.dof[iv + l].S, F[k]);
        M[(iv + k) * static_cast<std::ptrdiff_t>(n) + iv + l] = M[(iv + l) * static_cast<std::ptrdiff_t>(n) + iv + k] = x;
      }
    for (int j = i, up = p; up > 0; j = up, up = m.index[at(up)].parent) {
      for (int k = 0; k < Joint::nv; ++k) F[k].angular += cross(d.r[j], F[k].linear);
      const BodyIndex& x = m.index[at(up)];
      for (int l = 0; l < x.nv; ++l)
        for (int k = 0; k < Joint::nv; ++k) {
          const double value = dot(d.dof[x.idx_v + l].S, F[k]);
          M[(iv + k) * static_cast<std::ptrdiff_t>(n) + x.idx_v + l] = M[(x.idx_v + l) * static_cast<std::ptrdiff_t>(n) + iv + k] = value;
        }
    }
    if (p > 0) {
      d.Io[p] = d.Io[p] + shiftedInertia(d.Io[i], d.mass[i], d.h[i], d.r[i]);
      d.h[p] += d.h[i] + d.mass[i] * d.r[i];
      d.mass[p] += d.mass[i];
    }
  });
  for (std::size_t k = 0; k < m.armature.size(); ++k) M[k * static_cast<std::size_t>(n) + k] += m.armature[k];
}

/// G^T Mx G, coupling by coupling: the follower's row and column are added to its master's.
void reduceMassMatrix(const CompactImpl& m, const DataImpl& d, double* Mx, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const std::ptrdiff_t s = m.index[at(m.couplings[k].body)].idx_v, t = m.index[at(m.couplings[k].master)].idx_v;
    for (std::ptrdiff_t i = 0; i < n; ++i) Mx[t * n + i] += d.G[k] * Mx[s * n + i];
    for (std::ptrdiff_t i = 0; i < n; ++i) Mx[i * n + t] += d.G[k] * Mx[i * n + s];
  }
  for (std::size_t i = 0; i < m.v_of_user.size(); ++i)
    for (std::size_t j = 0; j < m.v_of_user.size(); ++j) M[i * m.v_of_user.size() + j] = Mx[m.v_of_user[i] * n + m.v_of_user[j]];
}

}  // namespace

const double* massMatrix(const CompactImpl& m, DataImpl& d) {
  expandedMassMatrix(m, d, m.couplings.empty() ? d.M : d.Mx);
  if (!m.couplings.empty()) reduceMassMatrix(m, d, d.Mx, d.M);
  return d.M;
}

namespace detail {
const double* crba(const CompactModel& model, Data& data, VectorView q) {
  checkData("crba", model, data, Need::mass_matrix);
  const Inputs in = readInputs("crba", model, data, q, nullptr, nullptr);
  evaluateJoints(model.impl(), data.impl(), in.q, nullptr);
  return massMatrix(model.impl(), data.impl());
}
}  // namespace detail

}  // namespace dyn
