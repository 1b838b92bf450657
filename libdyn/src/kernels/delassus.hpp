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
  // A few rows and a pack of columns at a time, above the diagonal, in registers through all degrees of freedom. Beyond a chain's rows its shares
  // are zero.
  for (int row = 0; row < c.rows; row += tile)
    inPacks<Wide, Half>(row, c.rows, [&]<class P>(int column, std::type_identity<P>) {
      P sums[tile];
      for (P& sum : sums) sum = P(0);
      for (const ConstrainedChain& chain : c.chains) {
        if (chain.row_begin >= row + tile || chain.row_end <= column) continue;
        for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
          const P share = loadPack<P>(x.shareOf(k) + column);
          const double* scaled = x.scaledOf(k) + row;
          for (int r = 0; r < tile; ++r) sums[r] += P(scaled[r]) * share;
        }
      }
      for (int r = 0; r < std::min(tile, c.rows - row); ++r) storeFirst(sums[r], c.rows - column, D[row + r] + column);
    });
  mirrorUpper<Wide>(D, c.rows);
}

/// Adds to x.yielded what degrees of freedom yield to forces of the rows. After an eliminated sweep. O(dofs x rows).
template <class Wide, class Half>
void yieldToRows(const PackedConstraints& c, const double* lambda, ConstraintWorkspace& x) {
  for (const ConstrainedChain& chain : c.chains)
    inGroups<Wide, Half>(chain.row_begin, chain.row_end,
                         [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
                           P forces[packs];
                           for (int p = 0; p < packs; ++p) forces[p] = loadPack<P>(lambda + first + p * lanes_of<P>);
                           for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
                             const double* scaled = x.scaledOf(k) + first;
                             P sum = loadPack<P>(scaled) * forces[0];
                             for (int p = 1; p < packs; ++p) sum += loadPack<P>(scaled + p * lanes_of<P>) * forces[p];
                             x.yielded[k] += total<double>(sum);
                           }
                         });
}

/// How x.yielded accelerates the rows: the Delassus matrix times forces, without the rounding of its entries, and what they cancel, before they make
/// any row move. `out` has room for a pack. O(dofs x rows).
template <class Wide, class Half>
void rowsOfYielded(const PackedConstraints& c, const ConstraintWorkspace& x, double* out) {
  inGroups<Wide, Half>(0, c.rows, [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
    constexpr int lanes = lanes_of<P>;
    P sum[packs];
    for (P& pack : sum) pack = P(0);
    for (const ConstrainedChain& chain : c.chains) {
      if (chain.row_begin >= first + packs * lanes || chain.row_end <= first) continue;
      for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
        const P yielded(x.yielded[k]);
        for (int p = 0; p < packs; ++p) sum[p] += yielded * loadPack<P>(x.shareOf(k) + first + p * lanes);
      }
    }
    for (int p = 0; p < packs; ++p) storePack(sum[p], out + first + p * lanes);
  });
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

/// Whether a pivot is no more than rounding of its row.
struct LeastPivot {
  const double* bound;
  double mu, tolerance;
  bool holds(double pivot, int row) const { return !(pivot <= tolerance * bound[row]) || mu > 0; }
};

/// The inverse of a block {{a, b}, {b, c}} at rows k and k + 1: one division, since the next block waits for it. False where a pivot vanishes.
inline bool invertBlock(double a, double b, double c, int k, const LeastPivot& least, double (&P)[2][2]) {
  const double determinant = a * c - b * b, factor = 1 / determinant;
  P[0][0] = factor * c;
  P[0][1] = P[1][0] = -(factor * b);
  P[1][1] = factor * a;
  return least.holds(a, k) && least.holds(determinant / a, k + 1);
}

/// A matrix that has its place in registers, with room for `most` rows of `packs` packs; its last rows and columns may be those of unity.
template <class Wide, int most, int packs>
class SmallInverse {
 public:
  SmallInverse(int rows, const ConstraintWorkspace& x, double mu) {
#pragma GCC unroll 16
    for (int i = 0; i < most; ++i)
#pragma GCC unroll 2
      for (int p = 0; p < packs; ++p) {
        const Wide e = unitPack<Wide>(i, p * width);
        B_[i][p] = i < rows ? -(loadPack<Wide>(x.delassus + i * x.stride + p * width) + Wide(mu) * e) : -e;
      }
  }
  bool run(int rows, const LeastPivot& least) {
    return [&]<int... pair>(std::integer_sequence<int, pair...>) {
      return ((2 * pair >= rows || exchange<2 * pair>(least)) && ...);
    }(std::make_integer_sequence<int, most / 2>());
  }
  void store(int rows, ConstraintWorkspace& x) const {
#pragma GCC unroll 16
    for (int i = 0; i < most; ++i)
#pragma GCC unroll 2
      for (int p = 0; p < packs; ++p)
        if (i < rows) storePack(B_[i][p], x.inverse + i * x.stride + p * width);
  }

 private:
  static constexpr int width = lanes_of<Wide>;
  using Numbers = typename Square<double, width>::Row;
  template <int column>
  double number(int row) const {
    return static_cast<Numbers>(B_[row][column / width].x)[column % width];
  }
  /// One of them in all lanes.
  template <int column>
  Wide inAll(int row) const {
    const auto numbers = static_cast<Numbers>(B_[row][column / width].x);
    return [&]<int... lane>(std::integer_sequence<int, lane...>) {
      return Wide(typename Wide::Batch(__builtin_shufflevector(numbers, numbers, (lane - lane + column % width)...)));
    }(std::make_integer_sequence<int, width>());
  }
  /// exchangeRows of rows k and k + 1.
  template <int k>
  bool exchange(const LeastPivot& least) {
    double P[2][2];
    if (!invertBlock(-number<k>(k), -number<k + 1>(k), -number<k + 1>(k + 1), k, least, P)) return false;
    Wide first[packs], second[packs], taken_first[packs], taken_second[packs];
#pragma GCC unroll 2
    for (int p = 0; p < packs; ++p) {
      const Wide e = unitPack<Wide>(k, p * width), f = unitPack<Wide>(k + 1, p * width), outside = Wide(1) - e - f;
      const Wide above = e - outside * B_[k][p], below = f - outside * B_[k + 1][p];
      first[p] = Wide(P[0][0]) * above + Wide(P[0][1]) * below;
      second[p] = Wide(P[1][0]) * above + Wide(P[1][1]) * below;
      taken_first[p] = first[p] + e;
      taken_second[p] = second[p] + f;
    }
#pragma GCC unroll 16
    for (int i = 0; i < most; ++i) {
      if (i == k || i == k + 1) continue;
      const Wide by_first = inAll<k>(i), by_second = inAll<k + 1>(i);
#pragma GCC unroll 2
      for (int p = 0; p < packs; ++p) B_[i][p] = B_[i][p] - by_first * taken_first[p] - by_second * taken_second[p];
    }
#pragma GCC unroll 2
    for (int p = 0; p < packs; ++p) {
      B_[k][p] = first[p];
      B_[k + 1][p] = second[p];
    }
    return true;
  }

  Wide B_[most][packs];
};
template <class Small>
bool invertSmall(int rows, ConstraintWorkspace& x, double mu, const LeastPivot& least) {
  Small small(rows, x, mu);
  if (!small.run(rows, least)) return false;
  small.store(rows, x);
  return true;
}

/// (D + mu)^-1 into x.inverse, two rows at a time: a product with it waits for nothing, where solutions with triangles wait for each row.
/// False where a pivot is not above tolerance times its bound; NaN goes on, to come out as NaN.
template <class Wide, class Half>
bool invertDelassus(int rows, ConstraintWorkspace& x, double mu, double tolerance) {
  const LeastPivot least{x.bound, mu, tolerance};
  if constexpr (lanes_of<Wide> == 8) {
    // Beside packs that wide there are 32 of them: two feet, or four points, have their place in registers.
    if (rows <= 8) return invertSmall<SmallInverse<Wide, 8, 1>>(rows, x, mu, least);
    if (rows <= 12) return invertSmall<SmallInverse<Wide, 12, 2>>(rows, x, mu, least);
  }
  // All rows of -A exchanged are those of A^-1.
  for (int i = 0; i < rows; ++i)
    inPacks<Wide, Half>(0, rows, [&]<class P>(int first, std::type_identity<P>) {
      storePack(-(loadPack<P>(x.delassus + i * x.stride + first) + P(mu) * unitPack<P>(i, first)), x.inverse + i * x.stride + first);
    });
  int k = 0;
  for (; k + 1 < rows; k += 2) {
    const double *upper = x.inverse + k * x.stride + k, *lower = upper + x.stride;
    double P[2][2];
    if (!invertBlock(-upper[0], -upper[1], -lower[1], k, least, P)) return false;
    exchangeRows<Wide, Half, 2>(rows, x, k, P);
  }
  if (k == rows) return true;
  const double pivot = -x.inverse[k * x.stride + k];
  if (!least.holds(pivot, k)) return false;
  exchangeRows<Wide, Half, 1>(rows, x, k, {{1 / pivot}});
  return true;
}

/// out = A x for a symmetric matrix of rows. Behind the last one nothing is written: zeros stay, which a product that is not finite would not be.
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
    storeFirst(even + odd, rows - first, out + first);
  });
}

}  // namespace dyn::kernels
