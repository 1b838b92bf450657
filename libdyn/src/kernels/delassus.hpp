// The Delassus matrix, its inverse, and products with either.
#pragma once

#include "kernels/constraint_workspace.hpp"
#include "kernels/row_packs.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// The Delassus matrix from the shares of an eliminated sweep, all of it. O(dofs x rows^2).
template <class Wide, class Half>
void delassusMatrix(const PackedConstraints& c, ConstraintWorkspace& x) {
  constexpr int tile = 4;
  const Rows<double> D{x.delassus, x.stride};
  std::fill(D[0], D[c.rows], 0.0);
  // A few rows and a pack of columns at a time, above the diagonal, in registers through a chain's degrees of freedom.
  for (const ConstrainedChain& chain : c.chains)
    for (int row = chain.row_begin; row < chain.row_end; row += tile)
      inPacks<Wide, Half>(row, chain.row_end, [&]<class P>(int column, std::type_identity<P>) {
        P sums[tile];
        for (P& sum : sums) sum = P(0);
        for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
          const P share = loadPack<P>(x.shareOf(k) + column);
          const double* scaled = x.scaledOf(k) + row;
          for (int r = 0; r < tile; ++r) sums[r] += P(scaled[r]) * share;
        }
        for (int r = 0; r < std::min(tile, chain.row_end - row); ++r) storePack(loadPack<P>(D[row + r] + column) + sums[r], D[row + r] + column);
      });
  mirrorUpper<Wide>(D, c.rows);
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

/// Rows and columns k to k + size of x.inverse exchanged (Gauss and Jordan, of a matrix that keeps its symmetry but for rounding), P the inverse of
/// the block where they meet, with the other sign.
template <class Wide, class Half, int size>
void exchangeRows(int rows, ConstraintWorkspace& x, int k, const double (&P)[size][size]) {
  const Rows<double> B{x.inverse, x.stride};
  // Each row by its own numbers: those that symmetry has for them differ by rounding, which the matrix' condition would multiply.
  double* factors = x.column;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < size; ++j) factors[size * i + j] = B[i][k + j];
  inGroups<Wide, Half>(0, rows, [&]<class Pk, int packs>(int first, std::type_identity<Pk>, std::integral_constant<int, packs>) {
    constexpr int lanes = lanes_of<Pk>;
    Pk exchanged[size][packs], taken[size][packs];
    for (int p = 0; p < packs; ++p) {
      const int column = first + p * lanes;
      Pk e[size], from[size], outside(1);
      for (int j = 0; j < size; ++j) {
        e[j] = unitPack<Pk>(k + j, column);
        outside -= e[j];
      }
      for (int j = 0; j < size; ++j) from[j] = e[j] - outside * loadPack<Pk>(B[k + j] + column);
      for (int i = 0; i < size; ++i) {
        exchanged[i][p] = Pk(P[i][0]) * from[0];
        for (int j = 1; j < size; ++j) exchanged[i][p] += Pk(P[i][j]) * from[j];
        taken[i][p] = exchanged[i][p] + e[i];
      }
    }
    for (int i = 0; i < rows; ++i) {
      Pk sum[packs];
      for (int p = 0; p < packs; ++p) sum[p] = loadPack<Pk>(B[i] + first + p * lanes);
      for (int j = 0; j < size; ++j) {
        const Pk factor(factors[size * i + j]);
        for (int p = 0; p < packs; ++p) sum[p] -= factor * taken[j][p];
      }
      for (int p = 0; p < packs; ++p) storePack(sum[p], B[i] + first + p * lanes);
    }
    for (int i = 0; i < size; ++i)
      for (int p = 0; p < packs; ++p) storePack(exchanged[i][p], B[k + i] + first + p * lanes);
  });
}

/// (D + mu)^-1 into x.inverse, two rows at a time: a product with it waits for nothing, where solutions with triangles wait for each row.
/// False where a pivot is not above tolerance times its bound; NaN goes on, to come out as NaN.
template <class Wide, class Half>
bool invertDelassus(int rows, ConstraintWorkspace& x, double mu, double tolerance) {
  const auto vanishes = [&](double pivot, int row) { return pivot <= tolerance * x.bound[row] && !(mu > 0); };
  // All rows of -A exchanged are those of A^-1.
  for (int i = 0; i < rows; ++i)
    inPacks<Wide, Half>(0, rows, [&]<class P>(int first, std::type_identity<P>) {
      storePack(-(loadPack<P>(x.delassus + i * x.stride + first) + P(mu) * unitPack<P>(i, first)), x.inverse + i * x.stride + first);
    });
  int k = 0;
  for (; k + 1 < rows; k += 2) {
    const double *upper = x.inverse + k * x.stride + k, *lower = upper + x.stride;
    const double a = -upper[0], b = -upper[1], c = -lower[1];
    if (vanishes(a, k)) return false;
    const double first = 1 / a, ratio = b * first, left = c - b * ratio;
    if (vanishes(left, k + 1)) return false;
    const double second = 1 / left, across = -ratio * second;
    exchangeRows<Wide, Half, 2>(rows, x, k, {{first - ratio * across, across}, {across, second}});
  }
  if (k == rows) return true;
  const double pivot = -x.inverse[k * x.stride + k];
  if (vanishes(pivot, k)) return false;
  exchangeRows<Wide, Half, 1>(rows, x, k, {{1 / pivot}});
  return true;
}

/// out = A x for a symmetric matrix of rows.
template <class Wide, class Half>
void timesRows(int rows, std::ptrdiff_t stride, const double* A, const double* x, double* out) {
  inPacks<Wide, Half>(0, rows, [&]<class P>(int first, std::type_identity<P>) {
    P even(0), odd(0);
    int k = 0;
    for (; k + 1 < rows; k += 2) {
      even += P(x[k]) * loadPack<P>(A + k * stride + first);
      odd += P(x[k + 1]) * loadPack<P>(A + (k + 1) * stride + first);
    }
    if (k < rows) even += P(x[k]) * loadPack<P>(A + k * stride + first);
    storePack(even + odd, out + first);
  });
}

}  // namespace dyn::kernels
