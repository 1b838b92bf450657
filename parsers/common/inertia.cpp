// SPDX-License-Identifier: BSD-2-Clause
#include "common/inertia.hpp"

#include <algorithm>
#include <cmath>

namespace dyn::reader {

namespace {

/// Whether a symmetric matrix is positive semi-definite, as its principal minors tell. `slack` is added to the diagonal. Entries are at most about 1,
/// so that no product of three of them leaves the range of doubles.
bool isPositiveSemidefinite(const Sym3<double>& I, double slack) {
  const double xy = I.xy, xz = I.xz, yz = I.yz, xx = I.xx + slack, yy = I.yy + slack, zz = I.zz + slack;
  const double determinant = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  return !(xx < 0 || yy < 0 || zz < 0 || xx * yy < xy * xy || xx * zz < xz * xz || yy * zz < yz * yz || determinant < 0);
}

}  // namespace

InertiaFaults faultsOf(const Inertia<double>& Y) {
  const Sym3<double>& given = Y.rotational;
  const double scale =
      std::max({std::fabs(given.xx), std::fabs(given.yy), std::fabs(given.zz), std::fabs(given.xy), std::fabs(given.xz), std::fabs(given.yz)});
  InertiaFaults out;
  out.massless = Y.mass == 0 && scale > 0;
  out.point = Y.mass > 0 && scale == 0;
  if (scale == 0) return out;
  const Sym3<double> I{given.xx / scale, given.xy / scale, given.xz / scale, given.yy / scale, given.yz / scale, given.zz / scale};
  const double slack = 1e-6 + 1e-15 * Y.mass * dot(Y.com, Y.com) / scale;
  out.indefinite = !isPositiveSemidefinite(I, slack);
  // Principal moments of a body satisfy A + B >= C, so the largest is at most half the trace: half * 1 - I is positive semi-definite.
  const double half = 0.5 * (I.xx + I.yy + I.zz);
  out.unreal = !isPositiveSemidefinite({half - I.xx, -I.xy, -I.xz, half - I.yy, -I.yz, half - I.zz}, slack);
  return out;
}

}  // namespace dyn::reader
