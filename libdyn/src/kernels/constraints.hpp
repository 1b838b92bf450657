// Forces of constraints on their way to the world, all rows at once, in packs over rows.
//
// A constraint's row is a unit force on one body, and the opposite one on another. Going up, each degree of freedom takes its share y of the
// force and, where it is free to move (eliminated), passes on what its articulated body does not yield to. The shares are J, or L^-T J^T with
// M = L^T D L; J M^-1 J^T, the Delassus matrix, is Y^T D^-1 Y. O(bodies between constraints and world x rows).
// Featherstone 2008, ch. 7 for the elimination; Popov and Vereshchagin 1978 and Featherstone 2010 (LTL factors, J M^-1 J^T) for its use.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// Arrays of one number a row of the constraints, `stride` numbers long: a multiple of the widest pack's.
struct ConstraintWorkspace {
  std::ptrdiff_t stride = 0;
  double* force = nullptr;     ///< see forceOf
  double* share = nullptr;     ///< one a degree of freedom of these bodies
  double* free = nullptr;      ///< acceleration of each row without constraint forces, from the sweep
  double* bound = nullptr;     ///< what the diagonal of the Delassus matrix could be if nothing cancelled and no lever lay along its force
  double* delassus = nullptr;  ///< rows of the matrix
  double* scaled = nullptr;    ///< the shares over the degrees of freedom's pivots
  double* inverse = nullptr;   ///< rows of its inverse
  double* column = nullptr;    ///< scratch of two rows
  double* motion = nullptr;    ///< one number a degree of freedom of these bodies: acceleration

  /// Of a force on the first body of a chain: about its joint's origin, aligned axes; last its reach, the square of the moment that it would have
  /// if all levers on its way stood square to it. Numbers of `widest` rows lie together, a component after the other.
  static constexpr int components = 7, reach = 6, widest = 8;
  double* forceOf(int chain, int row) const { return force + (chain * stride + row / widest * widest) * components + row % widest; }
  double* shareOf(int dof) const { return share + dof * stride; }
  double* scaledOf(int dof) const { return scaled + dof * stride; }
};

inline void carve(ConstraintWorkspace& x, const PackedConstraints& c, Arena& arena) {
  constexpr int widest = ConstraintWorkspace::widest;
  x.stride = (c.rows + widest - 1) / widest * widest;
  const auto stride = static_cast<std::size_t>(x.stride);
  arena.take(x.force, ConstraintWorkspace::components * stride * c.chains.size());
  arena.take(x.share, stride * c.dofs.size());
  arena.take(x.free, stride);
  arena.take(x.bound, stride);
  arena.take(x.delassus, stride * static_cast<std::size_t>(c.rows));
  arena.take(x.scaled, stride * c.dofs.size());
  arena.take(x.inverse, stride * static_cast<std::size_t>(c.rows));
  arena.take(x.column, 2 * stride);
  arena.take(x.motion, c.dofs.size());
}

/// From x.force, where constraints have put their columns (zero elsewhere), and x.share, where those on joints have put theirs.
/// Eliminated: after abaInward; `free` is the acceleration of the rows that abaSolve would find, with the world falling up.
/// Otherwise after abaOutward: shares are J, and `free` is what velocities alone give. Either way the bound is by dof.inverse, which is there
/// once joints have been eliminated, or as the caller has put it.
template <class Wide>
void constraintSweep(const CompactImpl& m, const Workspace<double>& w, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
  constexpr int width = lanes_of<Wide>, step = ConstraintWorkspace::widest;
  const auto load = [](const double* from) { return loadPack<Wide>(from); };
  const auto store = [](const Wide& value, double* to) { storePack(value, to); };
  std::fill_n(x.free, x.stride, 0.0);
  std::fill_n(x.bound, x.stride, 0.0);
  const bool on_joints = c.actsOnJoints();
  const auto along = [](const auto& s, const Force<Wide>& f) {
    return Wide(s.linear.x) * f.linear.x + Wide(s.linear.y) * f.linear.y + Wide(s.linear.z) * f.linear.z + Wide(s.angular.x) * f.angular.x +
           Wide(s.angular.y) * f.angular.y + Wide(s.angular.z) * f.angular.z;
  };
  for (std::size_t number = 0; number < c.chains.size(); ++number) {
    const ConstrainedChain& chain = c.chains[number];
    for (int first = chain.row_begin / width * width; first < chain.row_end; first += width) {
      const double* from = x.forceOf(static_cast<int>(number), first);
      Force<Wide> F{{load(from), load(from + step), load(from + 2 * step)}, {load(from + 3 * step), load(from + 4 * step), load(from + 5 * step)}};
      Wide free = load(x.free + first), bound = load(x.bound + first), reach = load(from + ConstraintWorkspace::reach * step);
      for (int place = chain.begin; place < chain.end; ++place) {
        const ConstrainedBody& here = c.bodies[static_cast<std::size_t>(place)];
        const BodyIndex& index = m.index[static_cast<std::size_t>(here.body)];
        const Vec3<double>& r = w.r[here.body];
        for (int k = 0; k < index.nv; ++k) {
          const DofFactor<double>& dof = w.dof[index.idx_v + k];
          double* share = x.shareOf(here.dof + k) + first;
          const Wide own = on_joints ? load(share) : Wide(0), y = own + along(dof.S_, F), scaled = Wide(dof.inverse) * y;
          store(y, share);
          store(scaled, x.scaledOf(here.dof + k) + first);
          const bool last = k == index.nv - 1;
          bound += Wide(dof.inverse) * (own * own + Wide(dot(dof.S_.linear, dof.S_.linear)) * dot(F.linear, F.linear) +
                                        Wide(dot(dof.S_.angular, dof.S_.angular)) * reach);
          if (last) {
            free += along(w.beta[here.body], F);
            reach += Wide(dot(r, r)) * dot(F.linear, F.linear);
          }
          if (!eliminated) continue;
          free += y * Wide(dof.y);
          const Wide less = last ? y : scaled;
          if (last) F.angular += cross(cast<Wide>(r), F.linear);  // abaInward has moved this W to the parent
          F.linear -= Vec3<Wide>{less * Wide(dof.W.linear.x), less * Wide(dof.W.linear.y), less * Wide(dof.W.linear.z)};
          F.angular -= Vec3<Wide>{less * Wide(dof.W.angular.x), less * Wide(dof.W.angular.y), less * Wide(dof.W.angular.z)};
        }
        if (!eliminated) F.angular += cross(cast<Wide>(r), F.linear);
      }
      const int top = c.bodies[static_cast<std::size_t>(chain.end - 1)].body;
      if (chain.parent < 0 && eliminated) {
        const Vec3<double> fall = m.index[static_cast<std::size_t>(top)].flying_root ? transposeTimes(w.rel[top].R, -m.gravity) : -m.gravity;
        free += Wide(fall.x) * F.linear.x + Wide(fall.y) * F.linear.y + Wide(fall.z) * F.linear.z;
      }
      store(free, x.free + first);
      store(bound, x.bound + first);
      if (chain.parent < 0) continue;
      double* to = x.forceOf(chain.parent, first);
      const auto add = [&](int component, const Wide& value) { store(load(to + component * step) + value, to + component * step); };
      for (int a = 0; a < 3; ++a) {
        add(a, F.linear[a]);
        add(3 + a, F.angular[a]);
      }
      add(ConstraintWorkspace::reach, reach);
    }
  }
}

/// The Delassus matrix from the shares of an eliminated sweep, all of it. O(dofs x rows^2).
template <class Wide>
void delassusMatrix(const PackedConstraints& c, ConstraintWorkspace& x) {
  constexpr int width = lanes_of<Wide>, tile = 8;
  // A tile of rows and a pack of columns at a time, above the diagonal, in registers through all degrees of freedom that have both.
  for (int row = 0; row < c.rows; row += tile)
    for (int column = row / width * width; column < c.rows; column += width) {
      Wide sums[tile];
      for (Wide& sum : sums) sum = Wide(0);
      for (const ConstrainedChain& chain : c.chains) {
        if (chain.row_end <= column || chain.row_begin >= std::min(row + tile, column + width) || chain.row_end <= row) continue;
        for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
          const Wide share = loadPack<Wide>(x.shareOf(k) + column);
          const double* scaled = x.scaledOf(k) + row;
          for (int r = 0; r < tile; ++r) sums[r] += Wide(scaled[r]) * share;
        }
      }
      for (int r = 0; r < std::min(tile, c.rows - row); ++r) storePack(sums[r], x.delassus + (row + r) * x.stride + column);
    }
  for (int row = 1; row < c.rows; ++row)
    for (int column = 0; column < row; ++column) x.delassus[row * x.stride + column] = x.delassus[column * x.stride + row];
}

/// Entry k of a vector is 1, in packs. Windows of a row of zeros around a one: what is written number by number and read as a pack stalls
/// the core.
template <class Wide>
Wide unitPack(int k, int first) {
  constexpr int width = lanes_of<Wide>;
  alignas(64) static constexpr auto unit = [] {
    std::array<double, 2 * width> e{};
    e[width] = 1;
    return e;
  }();
  const int shift = k - first;
  return shift < 0 || shift >= width ? Wide(0) : loadPack<Wide>(unit.data() + width - shift);
}

/// Rows and columns k to k + size of x.inverse exchanged (Gauss and Jordan), P the inverse of the block where they meet.
template <class Wide, int size>
void exchangeRows(int rows, ConstraintWorkspace& x, int k, const double (&P)[size][size]) {
  constexpr int width = lanes_of<Wide>;
  for (int first = 0; first < rows; first += width) {
    Wide e[size], row[size];
    Wide outside(1);
    for (int j = 0; j < size; ++j) {
      e[j] = unitPack<Wide>(k + j, first);
      outside -= e[j];
    }
    for (int j = 0; j < size; ++j) row[j] = outside * loadPack<Wide>(x.inverse + (k + j) * x.stride + first) + e[j];
    for (int i = 0; i < size; ++i) {
      Wide sum = Wide(P[i][0]) * row[0];
      for (int j = 1; j < size; ++j) sum += Wide(P[i][j]) * row[j];
      storePack(sum, x.inverse + (k + i) * x.stride + first);
      storePack(sum + e[i], x.column + i * x.stride + first);
    }
  }
  for (int i = 0; i < rows; ++i) {
    if (i >= k && i < k + size) continue;
    double* other = x.inverse + i * x.stride;
    Wide factor[size];
    for (int j = 0; j < size; ++j) factor[j] = Wide(-other[k + j]);
    for (int first = 0; first < rows; first += width) {
      Wide sum = loadPack<Wide>(other + first);
      for (int j = 0; j < size; ++j) sum += factor[j] * loadPack<Wide>(x.column + j * x.stride + first);
      storePack(sum, other + first);
    }
  }
}

/// (D + mu)^-1 into x.inverse, two rows at a time: a product with it waits for nothing, where solutions with triangles wait for each row.
/// False where a pivot is not above tolerance times its bound; NaN goes on, to come out as NaN.
template <class Wide>
bool invertDelassus(int rows, ConstraintWorkspace& x, double mu, double tolerance) {
  constexpr int width = lanes_of<Wide>;
  const auto vanishes = [&](double pivot, int row) { return pivot <= tolerance * x.bound[row] && !(mu > 0); };
  for (int i = 0; i < rows; ++i)
    for (int first = 0; first < rows; first += width)
      storePack(loadPack<Wide>(x.delassus + i * x.stride + first) + Wide(mu) * unitPack<Wide>(i, first), x.inverse + i * x.stride + first);
  int k = 0;
  for (; k + 1 < rows; k += 2) {
    const double *upper = x.inverse + k * x.stride + k, *lower = upper + x.stride;
    const double a = upper[0], b = upper[1], c = lower[1];
    if (vanishes(a, k)) return false;
    const double first = 1 / a, ratio = b * first, left = c - b * ratio;
    if (vanishes(left, k + 1)) return false;
    const double second = 1 / left, across = -ratio * second;
    exchangeRows<Wide, 2>(rows, x, k, {{first - ratio * across, across}, {across, second}});
  }
  if (k == rows) return true;
  const double pivot = x.inverse[k * x.stride + k];
  if (vanishes(pivot, k)) return false;
  exchangeRows<Wide, 1>(rows, x, k, {{1 / pivot}});
  return true;
}

/// out = A x for a symmetric matrix of rows.
template <class Wide>
void timesRows(int rows, std::ptrdiff_t stride, const double* A, const double* x, double* out) {
  constexpr int width = lanes_of<Wide>;
  for (int first = 0; first < rows; first += width) {
    Wide even(0), odd(0);
    int k = 0;
    for (; k + 1 < rows; k += 2) {
      even += Wide(x[k]) * loadPack<Wide>(A + k * stride + first);
      odd += Wide(x[k + 1]) * loadPack<Wide>(A + (k + 1) * stride + first);
    }
    if (k < rows) even += Wide(x[k]) * loadPack<Wide>(A + k * stride + first);
    storePack(even + odd, out + first);
  }
}

/// abaSolve for the bodies between constraints and the world only: w.acc and x.motion. O(these).
template <class Wide>
void accelerateConstrained(const CompactImpl& m, Workspace<double>& w, const PackedConstraints& c, const Vec3<double>& gravity,
                           ConstraintWorkspace& x) {
  w.acc[0] = {};
  for (std::size_t slot = c.bodies.size(); slot-- > 0;) {
    const ConstrainedBody& here = c.bodies[slot];
    const int i = here.body;
    const BodyIndex& index = m.index[static_cast<std::size_t>(i)];
    Motion<double> a = w.acc[index.parent];
    if (index.parent == 0) a.linear = index.flying_root ? transposeTimes(w.rel[i].R, -gravity) : -gravity;
    const int last = index.nv - 1;
    const DofFactor<double>& first = w.dof[index.idx_v + last];
    double qdd = first.y - dot(a, first.W);
    if (index.parent != 0) a.linear += cross(a.angular, w.r[i]);
    a += w.beta[i] + qdd * first.S_;
    x.motion[here.dof + last] = qdd;
    for (int k = last - 1; k >= 0; --k) {
      const DofFactor<double>& f = w.dof[index.idx_v + k];
      qdd = f.y - dot(a, f.W) * f.inverse;
      a += qdd * f.S_;
      x.motion[here.dof + k] = qdd;
    }
    w.acc[i] = a;
  }
}

/// Adds to what abaSolve starts from what forces of the constraints, one a row, give to each degree of freedom.
template <class Wide>
void addConstraintForces(const PackedConstraints& c, const ConstraintWorkspace& x, const double* lambda, Workspace<double>& w) {
  constexpr int width = lanes_of<Wide>;
  for (const ConstrainedChain& chain : c.chains)
    for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
      const double* scaled = x.scaledOf(k);
      Wide sum(0);
      for (int first = chain.row_begin / width * width; first < chain.row_end; first += width)
        sum += loadPack<Wide>(scaled + first) * loadPack<Wide>(lambda + first);
      w.dof[c.dofs[static_cast<std::size_t>(k)]].y += total<double>(sum);
    }
}

}  // namespace dyn::kernels
