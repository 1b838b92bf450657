// SPDX-License-Identifier: BSD-2-Clause
// The mass matrix of one state: composite inertias with vectors in registers, then four columns at once. With massMatrix() of crba.hpp in its place
// in vectored_kernels.hpp, on the same vectors, TALOS takes 1.36 times and iCub 1.29 times as long.
#pragma once

#include "kernels/order/vectored_bodies.hpp"
// Specialisations come before the templates that use them.
#include "kernels/pack/columns.hpp"
#include "kernels/recursion/crba.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Returns x with zeros in the lanes before `first`.
template <int first>
Vec4d from(const Vec4d& x) {
  return __builtin_shufflevector(Vec4d{}, x, (first > 0 ? 0 : 4), (first > 1 ? 1 : 5), (first > 2 ? 2 : 6), (first > 3 ? 3 : 7));
}

/// Rows and columns of M for `count` degrees of freedom of one chain, at most four. Their forces move to the root, each in a lane of the registers.
/// At each body on the way, the lanes write their entries with its degrees of freedom. On the chain itself, a lane joins at its own body. Entries
/// that were written for the lane before that are wrong; they are written again with the lane's own row.
template <int count>
struct ClimbingColumns {
  Vec4d fx, fy, fz, tx, ty, tz;  ///< forces, and moments about the origin of the body reached

  explicit ClimbingColumns(const DofFactor<Vectored>* dofs) {
    Square<double, 4> linear, angular;
    for (int l = 0; l < 4; ++l) {
      const Force<Vectored>& F = dofs[std::min(l, count - 1)].W;
      linear.rows[l] = F.linear.a;
      angular.rows[l] = F.angular.a;
    }
    linear.transpose();
    angular.transpose();
    fx = linear.rows[0], fy = linear.rows[1], fz = linear.rows[2];
    tx = angular.rows[0], ty = angular.rows[1], tz = angular.rows[2];
  }
  /// Moves the reference point of the moments by the joint offset r, in the lanes from `first` on.
  template <int first>
  void shift(const Vec3<Vectored>& r) {
    const Vec4d rx = inAll<0>(r.a), ry = inAll<1>(r.a), rz = inAll<2>(r.a), jx = from<first>(fx), jy = from<first>(fy), jz = from<first>(fz);
    tx += ry * jz - rz * jy;
    ty += rz * jx - rx * jz;
    tz += rx * jy - ry * jx;
  }
  void shiftFrom(int first, const Vec3<Vectored>& r) {
    switch (first) {
      case 1:
        return shift<1>(r);
      case 2:
        return shift<2>(r);
      case 3:
        return shift<3>(r);
      default:
        return shift<0>(r);
    }
  }
  Vec4d alongAxis(const Motion<Vectored>& s) const { return inAll<0>(s.angular.a) * tx + inAll<1>(s.angular.a) * ty + inAll<2>(s.angular.a) * tz; }
  Vec4d along(const Motion<Vectored>& s) const {
    return alongAxis(s) + (inAll<0>(s.linear.a) * fx + inAll<1>(s.linear.a) * fy + inAll<2>(s.linear.a) * fz);
  }
  /// Writes an entry of each lane to a row of M and to its mirror image, a column. `row` and `column` point to the first lane's entry.
  static void enter(const Vec4d& entries, double* row, double* column, std::ptrdiff_t n) {
    storeFirst<4>(entries, count, row);
    for (int l = 0; l < count; ++l) column[l * n] = entries[l];
  }
  void enterFloatingBase(double* row, double* column, std::ptrdiff_t n) const {
    const Vec4d parts[] = {fx, fy, fz, tx, ty, tz};
    for (int a = 0; a < 6; ++a) storeFirst<4>(parts[a], count, row + a * n);
    Square<double, 4> first, last;
    for (int a = 0; a < 4; ++a) {
      first.rows[a] = parts[a];
      last.rows[a] = parts[a + 2];
    }
    first.transpose();
    last.transpose();
    for (int l = 0; l < count; ++l) {
      first.write(l, column + l * n);
      last.write(l, column + l * n + 2);
    }
  }
};

/// Writes the rows and columns of `count` degrees of freedom, from `first` on.
template <int count>
DYN_FLATTEN __attribute__((noinline)) void enterColumns(const VectoredBodies& bodies, double* M, int first) {
  const std::ptrdiff_t n = bodies.m.nvx;
  double *const rows = M + first, *const columns = M + first * n;
  const DofFactor<Vectored>* const dofs = bodies.w.dof;
  const int end = first + count;
  ClimbingColumns<count> climbing(dofs + first);
  for (int body = bodies.m.dof_body[static_cast<std::size_t>(end - 1)];;) {
    const BodyIndex& x = bodies.index(body);
    double *row = rows + x.idx_v * n, *column = columns + x.idx_v;
    if (x.floating_base) return climbing.enterFloatingBase(row, column, n);
    if (x.contiguous_from <= body) {
      const Vec3<Vectored>* r = bodies.w.r + body;
      const DofFactor<Vectored>* dof = dofs + x.idx_v;
      const BodyIndex* here = &x;
      int left = body - x.contiguous_from;
      const auto climb = [&]<int joined>(std::integral_constant<int, joined>) {
        climbing.enter(climbing.alongAxis(dof->column), row, column, n);
        if (left-- == 0) return false;
        if (here->offset_axes != 0) climbing.template shift<joined>(*r);
        --here;
        --r;
        --dof;
        row -= n;
        --column;
        return true;
      };
      const auto climbContiguous = [&] {
        switch (x.idx_v - first) {
          case 3:
            if (!climb(std::integral_constant<int, 3>())) return;
            [[fallthrough]];
          case 2:
            if (!climb(std::integral_constant<int, 2>())) return;
            [[fallthrough]];
          case 1:
            if (!climb(std::integral_constant<int, 1>())) return;
            [[fallthrough]];
          default:
            while (climb(std::integral_constant<int, 0>())) {
            }
        }
      };
      climbContiguous();
      body = x.contiguous_from;
    } else {
      for (int k = 0; k < x.nv && x.idx_v + k < end; ++k) {
        const Motion<Vectored>& s = dofs[x.idx_v + k].column;
        climbing.enter(x.turns_only ? climbing.alongAxis(s) : climbing.along(s), row + k * n, column + k, n);
      }
    }
    const BodyIndex& reached = bodies.index(body);
    if (reached.parent == 0) return;
    if (reached.offset_axes != 0) climbing.shiftFrom(reached.idx_v - first, bodies.w.r[body]);
    body = reached.parent;
  }
}

/// Computes the same as massMatrix() of crba.hpp.
inline void massMatrixByColumns(const VectoredBodies& bodies, Workspace<Vectored>& w, Vectored* M) {
  columnsOutward(bodies, w);
  const auto composite = passing(w.mass, w.h, w.Io);
  bodies.backward(composite, [&]<class Joint>(const Joint&, int i, int iv, auto&& masses, auto&& moments, auto&& inertias) {
    const auto own = alignedInertia<Joint>(bodies, w, i);
    const Vectored mass = masses.with(own.mass);
    const Vec3<Vectored> h = moments.with(own.h);
    const Sym3<Vectored> I = inertias.with(own.Io);
    if constexpr (Joint::is_free)
      if (bodies.isRoot(i)) return enterFloatingBaseBlock(bodies, bodies.entry(M, i, iv), iv, mass, h, I);
    for (int k = 0; k < nvOf<Joint>(bodies, i); ++k) w.dof[iv + k].W = compositeForce<Joint>(w.dof[iv + k].column, mass, h, I);
    if (bodies.isRoot(i)) return;
    giveComposite(bodies, i, inertias, moments, masses, mass, h, I);
  });
  double* entries = reinterpret_cast<double*>(M);
  for (const DofChain& chain : bodies.m.chains) {
    const BodyIndex& top = bodies.index(bodies.m.dof_body[static_cast<std::size_t>(chain.begin)]);
    const int begin = chain.begin + (top.floating_base ? top.nv : 0);
    // The one to three degrees of freedom that do not fill the lanes are at the top of the chain, where the root path is shortest.
    int first = chain.end;
    for (; first - 4 >= begin; first -= 4) enterColumns<4>(bodies, entries, first - 4);
    if (first - begin == 3) enterColumns<3>(bodies, entries, begin);
    if (first - begin == 2) enterColumns<2>(bodies, entries, begin);
    if (first - begin == 1) enterColumns<1>(bodies, entries, begin);
  }
  const std::vector<double>& armature = bodies.m.armature;
  for (std::size_t k = 0; k < armature.size(); ++k)
    if (!bodies.index(bodies.m.dof_body[k]).floating_base) entries[k * (armature.size() + 1)] += armature[k];
}

}  // namespace dyn::kernels
