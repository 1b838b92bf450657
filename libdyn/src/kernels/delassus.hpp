// The Delassus matrix, its inverse, and products with either.
#pragma once

#include "kernels/constraint_workspace.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// The Delassus matrix from the shares of an eliminated sweep, all of it. O(dofs x rows^2).
template <class Wide>
void delassusMatrix(const PackedConstraints& c, ConstraintWorkspace& x) {
  constexpr int width = lanes_of<Wide>, tile = 4;
  const Rows<double> D{x.delassus, x.stride};
  std::fill(D[0], D[c.rows], 0.0);
  // A few rows and a pack of columns at a time, above the diagonal, in registers through a chain's degrees of freedom.
  for (const ConstrainedChain& chain : c.chains)
    for (int row = chain.row_begin; row < chain.row_end; row += tile)
      for (int column = row; column < chain.row_end; column += width) {
        Wide sums[tile];
        for (Wide& sum : sums) sum = Wide(0);
        for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
          const Wide share = loadPack<Wide>(x.shareOf(k) + column);
          const double* scaled = x.scaledOf(k) + row;
          for (int r = 0; r < tile; ++r) sums[r] += Wide(scaled[r]) * share;
        }
        for (int r = 0; r < std::min(tile, chain.row_end - row); ++r) storePack(loadPack<Wide>(D[row + r] + column) + sums[r], D[row + r] + column);
      }
  mirrorUpper<Wide>(D, c.rows, D);
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

}  // namespace dyn::kernels
