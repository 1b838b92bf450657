// SPDX-License-Identifier: BSD-2-Clause
// Dense matrices of exact numbers. Their operations are compiled once, in exact_matrix.cpp: a library of expression templates would cost the compiler
// ten seconds in every source. Sizes are checked by assert.
#pragma once

#include "exact_number.hpp"

#include <cassert>
#include <cstddef>
#include <vector>

namespace dyn::tool {

template <int digits>
class ExactView;

/// A matrix, column after column. A vector is a matrix of one column.
template <int digits>
class ExactMatrix {
 public:
  using Number = ExactNumber<digits>;
  using View = ExactView<digits>;
  using Index = std::ptrdiff_t;

  /// No rows and no columns.
  ExactMatrix();
  /// Zeros.
  explicit ExactMatrix(Index rows, Index cols = 1);
  /// A vector of three numbers.
  ExactMatrix(const Number& x, const Number& y, const Number& z);
  ExactMatrix(const ExactMatrix& x);
  ExactMatrix(ExactMatrix&& x) noexcept;
  ExactMatrix& operator=(const ExactMatrix& x);
  ExactMatrix& operator=(ExactMatrix&& x) noexcept;
  ~ExactMatrix();

  static ExactMatrix Zero(Index rows, Index cols = 1);
  /// A vector of equal numbers.
  static ExactMatrix Constant(Index n, const Number& x);
  static ExactMatrix Identity(Index n);
  /// Column k of the identity.
  static ExactMatrix Unit(Index n, Index k);
  /// The matrix K for which K x is the cross product of w and x.
  static ExactMatrix cross(const ExactMatrix& w);
  /// Matrices of as many columns, one below the other.
  static ExactMatrix stacked(const std::vector<ExactMatrix>& parts);
  /// The matrix with these columns.
  static ExactMatrix ofColumns(const std::vector<ExactMatrix>& columns);

  Index rows() const { return rows_; }
  Index cols() const { return cols_; }
  Index size() const { return rows_ * cols_; }
  Number* data() { return entries_.data(); }
  const Number* data() const { return entries_.data(); }
  Number& operator()(Index i, Index j) {
    assert(i >= 0 && i < rows_ && j >= 0 && j < cols_);
    return entries_[static_cast<std::size_t>(j * rows_ + i)];
  }
  const Number& operator()(Index i, Index j) const { return const_cast<ExactMatrix&>(*this)(i, j); }
  /// Entry k, column after column.
  Number& operator[](Index k) {
    assert(k >= 0 && k < size());
    return entries_[static_cast<std::size_t>(k)];
  }
  const Number& operator[](Index k) const { return const_cast<ExactMatrix&>(*this)[k]; }

  // Parts of a variable can be written. Parts of constants and of results are copies.
  View block(Index i, Index j, Index rows, Index cols) &;
  ExactMatrix block(Index i, Index j, Index rows, Index cols) const&;
  View row(Index i) &;
  ExactMatrix row(Index i) const& { return block(i, 0, 1, cols_); }
  View col(Index j) &;
  ExactMatrix col(Index j) const& { return block(0, j, rows_, 1); }
  View topRows(Index n) &;
  ExactMatrix topRows(Index n) const& { return block(0, 0, n, cols_); }
  View middleRows(Index i, Index n) &;
  ExactMatrix middleRows(Index i, Index n) const& { return block(i, 0, n, cols_); }
  View bottomRows(Index n) &;
  ExactMatrix bottomRows(Index n) const& { return block(rows_ - n, 0, n, cols_); }

  ExactMatrix operator-() const;
  ExactMatrix operator+(const ExactMatrix& x) const;
  ExactMatrix operator-(const ExactMatrix& x) const;
  ExactMatrix operator*(const ExactMatrix& x) const;
  ExactMatrix operator*(const Number& by) const;
  ExactMatrix operator/(const Number& by) const;
  friend ExactMatrix operator*(const Number& by, const ExactMatrix& x) { return x * by; }
  ExactMatrix& operator+=(const ExactMatrix& x);
  ExactMatrix& operator-=(const ExactMatrix& x);
  ExactMatrix& operator*=(const Number& by);
  ExactMatrix& operator/=(const Number& by);
  bool operator==(const ExactMatrix& x) const;

  ExactMatrix transpose() const;
  /// By elimination with pivots.
  ExactMatrix inverse() const;
  /// The entries' absolute values.
  ExactMatrix absolute() const;
  bool isZero() const;
  Number dot(const ExactMatrix& x) const;
  Number squaredNorm() const { return dot(*this); }
  Number norm() const { return sqrt(squaredNorm()); }
  Number trace() const;
  /// Row after row.
  std::vector<long double> rounded() const;

 private:
  Index rows_ = 0, cols_ = 0;
  std::vector<Number> entries_;
};

/// Entries of a matrix that are written in place. The matrix must outlive the view.
template <int digits>
class ExactView {
 public:
  using Number = ExactNumber<digits>;
  using Matrix = ExactMatrix<digits>;

  ExactView(const ExactView&) = default;
  ExactView& operator=(const ExactView& x) { return *this = Matrix(x); }  // NOLINT: a copy of the entries is made first
  ExactView& operator=(const Matrix& x);
  ExactView& operator+=(const Matrix& x);
  ExactView& operator-=(const Matrix& x);
  operator Matrix() const;  // NOLINT(google-explicit-constructor): a view is written where a matrix is meant

 private:
  friend class ExactMatrix<digits>;
  ExactView(Number* first, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t step) : first_(first), rows_(rows), cols_(cols), step_(step) {}

  Number* first_;
  std::ptrdiff_t rows_, cols_, step_;  ///< from one column to the next
};

extern template class ExactMatrix<50>;
extern template class ExactMatrix<100>;
extern template class ExactView<50>;
extern template class ExactView<100>;

}  // namespace dyn::tool
