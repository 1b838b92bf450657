// SPDX-License-Identifier: BSD-2-Clause
// The Delassus matrix D = J M^-1 J^T, its inverse, and products with either (Popov and Vereshchagin 1978; Featherstone 2010 for the factors).
//
// With y(k, r) = x.projection, the projection of row r's unit force on degree of freedom k (constraint_recursions.hpp), and d_k the pivot of k:
//   (1)  scaled(k, r) = y(k, r) / d_k,   D_rs = sum_k scaled(k, r) y(k, s)
//   (2)  response_k += sum_r scaled(k, r) lambda_r                                     response of the degrees of freedom to forces lambda
//   (3)  out_r = sum_k response_k y(k, r)                                              their effect on the rows; D lambda if (2) begins with zeros
// The inverse comes from exchanges (Gauss and Jordan) of blocks K of one or two rows, o the other rows, which turn B = -(D + mu) into (D + mu)^-1:
//   (4)  P = (-B_KK)^-1,   B_oo += B_oK P B_Ko,   B_oK = -B_oK P,   B_Ko = -P B_Ko,   B_KK = P
#pragma once

#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/order/subtree.hpp"
#include "kernels/pack/row_packs.hpp"

namespace dyn::kernels {

/// (1): the whole Delassus matrix from the projections of an eliminated sweep. O(dofs x rows^2).
template <class Wide, class Half, class T>
void delassusMatrix(const PackedConstraints& c, BasicConstraintWorkspace<T>& x) {
  constexpr int tile = 4;
  const Rows<T> D{x.delassus, x.stride};
  // A few rows and a pack of columns above the diagonal stay in registers through all degrees of freedom. A chain's projections are zero beyond its
  // rows.
  for (int row = 0; row < c.rows; row += tile)
    inPacks<Wide, Half, T>(row, c.rows, [&]<class P>(int column, std::type_identity<P>) {
      P sums[tile];
      for (P& sum : sums) sum = P(0);
      for (const ConstrainedChain& chain : c.chains) {
        if (chain.row_begin >= row + tile || chain.row_end <= column) continue;
        for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
          const P projection = loadPack<P>(x.projectionOf(k) + column);
          const T* scaled = x.scaledOf(k) + row;
          for (int r = 0; r < tile; ++r) sums[r] += P(scaled[r]) * projection;
        }
      }
      for (int r = 0; r < std::min(tile, c.rows - row); ++r) storeFirst(sums[r], c.rows - column, D[row + r] + column);
    });
  mirrorUpper<Wide>(D, c.rows);
}

/// (2): adds the response to forces lambda of the rows to x.response. After an eliminated sweep. O(dofs x rows).
template <class Wide, class Half, class T>
void respondToRows(const PackedConstraints& c, const T* lambda, BasicConstraintWorkspace<T>& x) {
  for (const ConstrainedChain& chain : c.chains)
    inGroups<Wide, Half, T>(chain.row_begin, chain.row_end,
                            [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
                              constexpr int rows = rows_of<P, T>;
                              P forces[packs];
                              for (int p = 0; p < packs; ++p) forces[p] = loadPack<P>(lambda + first + p * rows);
                              for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
                                const T* scaled = x.scaledOf(k) + first;
                                P sum = loadPack<P>(scaled) * forces[0];
                                for (int p = 1; p < packs; ++p) sum += loadPack<P>(scaled + p * rows) * forces[p];
                                x.response[k] += total<T>(sum);
                              }
                            });
}

/// (3): the accelerations of the rows due to x.response. This is more accurate than the Delassus matrix times lambda: its entries have been rounded,
/// and forces that cancel do so here before they reach the rows. `out` has room for a pack. O(dofs x rows).
template <class Wide, class Half, class T>
void rowsOfResponse(const PackedConstraints& c, const BasicConstraintWorkspace<T>& x, T* out) {
  inGroups<Wide, Half, T>(0, c.rows, [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
    constexpr int rows = rows_of<P, T>;
    P sum[packs];
    for (P& pack : sum) pack = P(0);
    for (const ConstrainedChain& chain : c.chains) {
      if (chain.row_begin >= first + packs * rows || chain.row_end <= first) continue;
      for (int k = chain.dof_begin; k < chain.dof_end; ++k) {
        const P response(x.response[k]);
        for (int p = 0; p < packs; ++p) sum[p] += response * loadPack<P>(x.projectionOf(k) + first + p * rows);
      }
    }
    for (int p = 0; p < packs; ++p) storePack(sum[p], out + first + p * rows);
  });
}

/// The pack from entry `first` on of a vector whose entry k is 1 and whose other entries are 0. It is read from a constant array with a one between
/// zeros: reading a pack soon after its numbers were written one by one stalls the core.
template <class Wide, class T = double>
Wide unitPack(int k, int first) {
  constexpr int width = lanes_of<Wide>;
  if constexpr (rows_of<Wide, T> == 1) return k == first ? Wide(1) : Wide(0);
  alignas(64) static constexpr auto unit = [] {
    std::array<double, 2 * width> e{};
    e[width] = 1;
    return e;
  }();
  const int shift = k - first;
  return shift < 0 || shift >= width ? Wide(0) : loadPack<Wide>(unit.data() + width - shift);
}

/// (4) for rows and columns [k, k + size) of x.inverse, with the given P. The matrix stays symmetric except for rounding.
template <class Wide, class Half, int size, class T>
void exchangeRows(int rows, BasicConstraintWorkspace<T>& x, int k, const T (&P)[size][size]) {
  const Rows<T> B{x.inverse, x.stride};
  // Factors come from each row itself. By symmetry they could come from rows k on, but the rounding differences would grow with the condition number.
  T* factors = x.column;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < size; ++j) factors[size * i + j] = B[i][k + j];
  inGroups<Wide, Half, T>(0, rows, [&]<class Pk, int packs>(int first, std::type_identity<Pk>, std::integral_constant<int, packs>) {
    constexpr int lanes = rows_of<Pk, T>;
    Pk exchanged[size][packs], taken[size][packs];
    for (int p = 0; p < packs; ++p) {
      const int column = first + p * lanes;
      Pk e[size], from[size], outside(1);
      for (int j = 0; j < size; ++j) {
        e[j] = unitPack<Pk, T>(k + j, column);
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

/// The test that a pivot is more than rounding of its row. With mu > 0 it always holds.
struct LeastPivot {
  const double* bound;
  double mu, tolerance;
  bool holds(double pivot, int row) const { return !(pivot <= tolerance * bound[row]) || mu > 0; }
};
/// The same for states in packs: marks the states where a pivot does not hold by a number that is not 0, and goes on.
template <class T>
struct LeastPivots {
  const T* bound;
  double tolerance;
  T& marks;
  bool holds(const T& pivot, int row) const {
    marks = select(pivot <= T(tolerance) * bound[row], T(1), marks);
    return true;
  }
};

/// Inverts a block {{a, b}, {b, c}} at rows k and k + 1 with one division, because the next block waits for the result. Returns false if a pivot
/// vanishes.
template <class T, class Least>
bool invertBlock(const T& a, const T& b, const T& c, int k, const Least& least, T (&P)[2][2]) {
  const T determinant = a * c - b * b, factor = T(1) / determinant;
  P[0][0] = factor * c;
  P[0][1] = P[1][0] = -(factor * b);
  P[1][1] = factor * a;
  return least.holds(a, k) && least.holds(determinant / a, k + 1);
}

/// A matrix in registers, with room for `most` rows of `packs` packs. Unused rows and columns are those of the unit matrix.
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
  /// Returns that number in all lanes.
  template <int column>
  Wide inAll(int row) const {
    const auto numbers = static_cast<Numbers>(B_[row][column / width].x);
    return [&]<int... lane>(std::integer_sequence<int, lane...>) {
      return Wide(typename Wide::Batch(__builtin_shufflevector(numbers, numbers, (lane - lane + column % width)...)));
    }(std::make_integer_sequence<int, width>());
  }
  /// exchangeRows for rows k and k + 1.
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

/// Writes (D + mu)^-1 to x.inverse, two rows at a time. Products with the inverse have independent rows, while solutions with triangular factors wait
/// for each row. Returns false if a pivot does not hold. NaN does not stop it and comes out as NaN.
template <class Wide, class Half, class T, class Least>
bool exchangeAllRows(int rows, BasicConstraintWorkspace<T>& x, double mu, const Least& least) {
  // Exchanging all rows turns -A into A^-1.
  for (int i = 0; i < rows; ++i)
    inPacks<Wide, Half, T>(0, rows, [&]<class P>(int first, std::type_identity<P>) {
      storePack(-(loadPack<P>(x.delassus + i * x.stride + first) + P(mu) * unitPack<P, T>(i, first)), x.inverse + i * x.stride + first);
    });
  int k = 0;
  for (; k + 1 < rows; k += 2) {
    const T *upper = x.inverse + k * x.stride + k, *lower = upper + x.stride;
    T P[2][2];
    if (!invertBlock(-upper[0], -upper[1], -lower[1], k, least, P)) return false;
    exchangeRows<Wide, Half, 2>(rows, x, k, P);
  }
  if (k == rows) return true;
  const T pivot = -x.inverse[k * x.stride + k];
  if (!least.holds(pivot, k)) return false;
  const T P[1][1] = {{T(1) / pivot}};
  exchangeRows<Wide, Half, 1>(rows, x, k, P);
  return true;
}

/// (D + mu)^-1 of one state. A pivot holds if it is above tolerance times its bound.
template <class Wide, class Half>
bool invertDelassus(int rows, ConstraintWorkspace& x, double mu, double tolerance) {
  const LeastPivot least{x.bound, mu, tolerance};
  if constexpr (lanes_of<Wide> == 8) {
    // Processors with packs this wide have 32 registers: the matrix of two feet or of four points fits into them.
    if (rows <= 8) return invertSmall<SmallInverse<Wide, 8, 1>>(rows, x, mu, least);
    if (rows <= 12) return invertSmall<SmallInverse<Wide, 12, 2>>(rows, x, mu, least);
  }
  return exchangeAllRows<Wide, Half>(rows, x, mu, least);
}

/// out = A x for a symmetric matrix. Nothing is written behind the last row, so the zeros there stay even if the product is not finite.
template <class Wide, class Half, class T>
void timesRows(int rows, std::ptrdiff_t stride, const T* A, const T* x, T* out) {
  inPacks<Wide, Half, T>(0, rows, [&]<class P>(int first, std::type_identity<P>) {
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
