// SPDX-License-Identifier: BSD-2-Clause
// The equations of constrained motion for many right-hand sides at once,
//   M x - J^T lambda = -force,   J x = -row,
// by their inverse. With P the inverse of the Delassus matrix J M^-1 J^T, B = M^-1 J^T P and K = M^-1 - B J M^-1,
//   x = -K force - B row,   lambda = B^T force - P row
// (Featherstone 2008, ch. 8.4). Derivatives of trees have many zeros. Products with the inverse skip the zeros that the tree implies; solutions with
// factors could not.
#pragma once

#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/derivative/tile.hpp"

namespace dyn::kernels {

/// The neighbouring degrees of freedom [begin, end).
struct DofRun {
  int begin, end;
};
struct DofRuns {
  const DofRun* first = nullptr;
  int count = 0;
  const DofRun* begin() const { return first; }
  const DofRun* end() const { return first + count; }
};

/// The negative inverse, a row for each entry of `force` and of `row`: first its effect on lambda, `multipliers` numbers of which the last ones are
/// unused, then its effect on x.
struct ConstrainedInverse {
  int n = 0, rows = 0;
  std::ptrdiff_t multipliers = 0;
  Rows<double> of_force, of_row;
  Rows<double> projected;  ///< -J M^-1
  int width() const { return static_cast<int>(multipliers) + n; }
};

inline void layOut(ConstrainedInverse& x, const ConstraintWorkspace& w, int rows, int n, Arena& arena) {
  x.n = n;
  x.rows = rows;
  x.multipliers = w.stride;
  arena.take(x.of_force, n, x.width());
  arena.take(x.of_row, rows, x.width());
  arena.take(x.projected, rows, n);
}

/// Forms the inverse from M^-1, n x n and followed by room for a pack, from J, rows x n, whose columns outside `moving` are zero, and from P, which
/// is in x.of_row. Unless null, x_by_tau (with room for a pack after it) and lambda_by_tau get the derivatives of x and lambda by tau = -force, with
/// columns that follow one another without gaps. O(n^2 rows).
template <class Wide>
void invertConstrained(const double* M_inverse, const double* J, const DofRuns moving, const ConstrainedInverse x, double* x_by_tau,
                       double* lambda_by_tau) {
  const int n = x.n, rows = x.rows;
  const std::ptrdiff_t lambda = x.multipliers;
  inPanels<Wide, double>(0, n, [&](auto packs, int first) {
    inBlocks<2>(0, rows, [&](auto count, int row) {
      Tile<Wide, double, count, packs> tile;
      for (const DofRun& run : moving) tile.subtract(M_inverse + run.begin * n + first, n, run.end - run.begin, J + run.begin * rows + row, 1, rows);
      tile.store(x.projected[row] + first, x.projected.stride);
    });
    inBlocks<2>(0, rows, [&](auto count, int row) {
      Tile<Wide, double, count, packs> tile;
      tile.subtract(x.projected[0] + first, x.projected.stride, rows, x.of_row[row], x.of_row.stride, 1);
      tile.store(x.of_row[row] + lambda + first, x.of_row.stride);
    });
  });
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < n; ++k) x.of_force[k][row] = -x.of_row[row][lambda + k];
  if (lambda_by_tau)
    for (int k = 0; k < n; ++k)
      for (int row = 0; row < rows; ++row) lambda_by_tau[rows * k + row] = x.of_force[k][row];
  inPanels<Wide, double>(0, n, [&](auto packs, int first) {
    inBlocks<2>(0, n, [&](auto count, int k) {
      Tile<Wide, double, count, packs> tile(M_inverse + k * n + first, n);
      tile.subtract(x.projected[0] + first, x.projected.stride, rows, x.of_force[k], x.of_force.stride, 1);
      tile.store(x.of_force[k] + lambda + first, x.of_force.stride);
      if (x_by_tau) tile.store(x_by_tau + k * n + first, n);
    });
  });
}

/// Matrices of n columns that follow one another without gaps: `force` and `x` with n numbers a column, `row` and `lambda` with one number for each
/// row. There are one or two of each; the second begins `next_...` numbers after the first. Results have room for a pack after their last number.
struct ConstrainedColumns {
  const double *force, *row;  ///< null: zero
  double *x, *lambda;
  std::ptrdiff_t next_force, next_row, next_x, next_lambda;
};

/// The pattern says which entries can be non-zero: column k of `force` in runs[k], column k of `row` only if moves[k]. If twins[k], column k + 1 has
/// the same pattern as column k.
struct ColumnPattern {
  const DofRuns* runs;
  const char *moves, *twins;
};

/// Solves the equations for all columns. O(entries (n + rows)).
template <class Wide, int sides>
void solveConstrained(const ConstrainedInverse x, const ColumnPattern pattern, const ConstrainedColumns c) {
  constexpr int width = lanes_of<Wide>;
  // Two columns of each matrix at once where their sums fit into registers: processors with the widest packs have 32 registers.
  constexpr int most = width >= 8 ? 2 : 1;
  const auto solve = [&]<int count>(std::integral_constant<int, count>, std::ptrdiff_t k) {
    const auto place = [&](auto* first, std::ptrdiff_t next, int row, std::ptrdiff_t length) {
      return first + row / count * next + (k + row % count) * length;
    };
    inPanels<Wide, double>(0, x.width(), [&](auto packs, int first) {
      constexpr int rows = sides * count;
      Tile<Wide, double, rows, packs> tile;
      const double* factors[rows];
      if (c.force)
        for (const DofRun& run : pattern.runs[k]) {
          for (int r = 0; r < rows; ++r) factors[r] = place(c.force, c.next_force, r, x.n) + run.begin;
          tile.subtract(x.of_force[run.begin] + first, x.of_force.stride, run.end - run.begin, factors);
        }
      if (c.row && pattern.moves[k]) {
        for (int r = 0; r < rows; ++r) factors[r] = place(c.row, c.next_row, r, x.rows);
        tile.subtract(x.of_row[0] + first, x.of_row.stride, x.rows, factors);
      }
      for (int r = 0; r < rows; ++r)
        for (int p = 0; p < packs; ++p) {
          const std::ptrdiff_t at = first + p * width, own = at - x.multipliers;
          storePack(tile.sum[r][p], own < 0 ? place(c.lambda, c.next_lambda, r, x.rows) + at : place(c.x, c.next_x, r, x.n) + own);
        }
    });
  };
  for (std::ptrdiff_t k = 0; k < x.n;) {
    if (pattern.twins[k]) {
      solve(std::integral_constant<int, most>(), k);
      k += most;
    } else {
      solve(std::integral_constant<int, 1>(), k++);
    }
  }
}

}  // namespace dyn::kernels
