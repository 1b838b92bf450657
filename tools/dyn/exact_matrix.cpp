// SPDX-License-Identifier: BSD-2-Clause
#include "exact_matrix.hpp"

#include <algorithm>

namespace dyn::tool {

namespace {

/// Calls use(entry of the view, number of the entry in a matrix of the view's size).
template <class Number, class Use>
void eachEntry(Number* first, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t step, Use&& use) {
  for (std::ptrdiff_t j = 0; j < cols; ++j)
    for (std::ptrdiff_t i = 0; i < rows; ++i) use(first[j * step + i], j * rows + i);
}

/// The sum of n products.
template <int digits>
ExactNumber<digits> sumOfProducts(const ExactNumber<digits>* a, std::ptrdiff_t step, const ExactNumber<digits>* b, std::ptrdiff_t n) {
  if (n == 0) return {};
  ExactNumber<digits> sum = a[0] * b[0];
  for (std::ptrdiff_t k = 1; k < n; ++k) sum += a[k * step] * b[k];
  return sum;
}

}  // namespace

template <int digits>
ExactMatrix<digits>::ExactMatrix() = default;
template <int digits>
ExactMatrix<digits>::ExactMatrix(Index rows, Index cols) : rows_(rows), cols_(cols), entries_(static_cast<std::size_t>(rows * cols)) {}
template <int digits>
ExactMatrix<digits>::ExactMatrix(const Number& x, const Number& y, const Number& z) : rows_(3), cols_(1), entries_{x, y, z} {}
template <int digits>
ExactMatrix<digits>::ExactMatrix(const ExactMatrix& x) = default;
template <int digits>
ExactMatrix<digits>::ExactMatrix(ExactMatrix&& x) noexcept = default;
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator=(const ExactMatrix& x) = default;
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator=(ExactMatrix&& x) noexcept = default;
template <int digits>
ExactMatrix<digits>::~ExactMatrix() = default;

template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::Zero(Index rows, Index cols) {
  return ExactMatrix(rows, cols);
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::Constant(Index n, const Number& x) {
  ExactMatrix out(n);
  std::fill(out.entries_.begin(), out.entries_.end(), x);
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::Identity(Index n) {
  ExactMatrix out(n, n);
  for (Index k = 0; k < n; ++k) out(k, k) = Number(1);
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::Unit(Index n, Index k) {
  ExactMatrix out(n);
  out[k] = Number(1);
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::cross(const ExactMatrix& w) {
  assert(w.size() == 3);
  ExactMatrix out(3, 3);
  for (Index i = 0; i < 3; ++i) {
    const Index j = (i + 1) % 3, k = (i + 2) % 3;
    out(k, j) = w[i];
    out(j, k) = -w[i];
  }
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::stacked(const std::vector<ExactMatrix>& parts) {
  Index rows = 0;
  for (const ExactMatrix& part : parts) rows += part.rows();
  ExactMatrix out(rows, parts.empty() ? 0 : parts.front().cols());
  rows = 0;
  for (const ExactMatrix& part : parts) {
    out.middleRows(rows, part.rows()) = part;
    rows += part.rows();
  }
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::ofColumns(const std::vector<ExactMatrix>& columns) {
  ExactMatrix out(columns.empty() ? 0 : columns.front().rows(), static_cast<Index>(columns.size()));
  for (std::size_t k = 0; k < columns.size(); ++k) out.col(static_cast<Index>(k)) = columns[k];
  return out;
}

template <int digits>
ExactView<digits> ExactMatrix<digits>::block(Index i, Index j, Index rows, Index cols) & {
  assert(i >= 0 && j >= 0 && rows >= 0 && cols >= 0 && i + rows <= rows_ && j + cols <= cols_);
  return {data() + j * rows_ + i, rows, cols, rows_};
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::block(Index i, Index j, Index rows, Index cols) const& {
  return const_cast<ExactMatrix&>(*this).block(i, j, rows, cols);
}
template <int digits>
ExactView<digits> ExactMatrix<digits>::row(Index i) & {
  return block(i, 0, 1, cols_);
}
template <int digits>
ExactView<digits> ExactMatrix<digits>::col(Index j) & {
  return block(0, j, rows_, 1);
}
template <int digits>
ExactView<digits> ExactMatrix<digits>::topRows(Index n) & {
  return block(0, 0, n, cols_);
}
template <int digits>
ExactView<digits> ExactMatrix<digits>::middleRows(Index i, Index n) & {
  return block(i, 0, n, cols_);
}
template <int digits>
ExactView<digits> ExactMatrix<digits>::bottomRows(Index n) & {
  return block(rows_ - n, 0, n, cols_);
}

template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator-() const {
  ExactMatrix out = *this;
  for (Number& entry : out.entries_) entry = -entry;
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator+(const ExactMatrix& x) const {
  ExactMatrix out = *this;
  out += x;
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator-(const ExactMatrix& x) const {
  ExactMatrix out = *this;
  out -= x;
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator*(const ExactMatrix& x) const {
  assert(cols_ == x.rows_);
  ExactMatrix out(rows_, x.cols_);
  for (Index j = 0; j < x.cols_; ++j)
    for (Index i = 0; i < rows_; ++i) out(i, j) = sumOfProducts(data() + i, rows_, x.data() + j * cols_, cols_);
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator*(const Number& by) const {
  ExactMatrix out = *this;
  out *= by;
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::operator/(const Number& by) const {
  ExactMatrix out = *this;
  out /= by;
  return out;
}
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator+=(const ExactMatrix& x) {
  assert(rows_ == x.rows_ && cols_ == x.cols_);
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k] += x.entries_[k];
  return *this;
}
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator-=(const ExactMatrix& x) {
  assert(rows_ == x.rows_ && cols_ == x.cols_);
  for (std::size_t k = 0; k < entries_.size(); ++k) entries_[k] -= x.entries_[k];
  return *this;
}
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator*=(const Number& by) {
  for (Number& entry : entries_) entry *= by;
  return *this;
}
template <int digits>
ExactMatrix<digits>& ExactMatrix<digits>::operator/=(const Number& by) {
  for (Number& entry : entries_) entry /= by;
  return *this;
}
template <int digits>
bool ExactMatrix<digits>::operator==(const ExactMatrix& x) const {
  return rows_ == x.rows_ && cols_ == x.cols_ && entries_ == x.entries_;
}

template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::transpose() const {
  ExactMatrix out(cols_, rows_);
  for (Index j = 0; j < cols_; ++j)
    for (Index i = 0; i < rows_; ++i) out(j, i) = (*this)(i, j);
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::inverse() const {
  assert(rows_ == cols_);
  // Column k of the array is row k of [A, 1], which becomes [1, A^-1].
  const Index n = rows_;
  std::vector<ExactMatrix> rows;
  for (Index k = 0; k < n; ++k) {
    ExactMatrix& row = rows.emplace_back(2 * n);
    for (Index c = 0; c < n; ++c) row[c] = (*this)(k, c);
    row[n + k] = Number(1);
  }
  for (Index k = 0; k < n; ++k) {
    const auto larger = [k](const ExactMatrix& a, const ExactMatrix& b) { return abs(a[k]) < abs(b[k]); };
    const auto pivot = rows.begin() + k;
    std::iter_swap(pivot, std::max_element(pivot, rows.end(), larger));
    *pivot *= Number(1) / Number((*pivot)[k]);
    for (auto other = rows.begin(); other != rows.end(); ++other)
      if (other != pivot) *other -= *pivot * Number((*other)[k]);
  }
  ExactMatrix out(n, n);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) out(i, j) = rows[static_cast<std::size_t>(i)][n + j];
  return out;
}
template <int digits>
ExactMatrix<digits> ExactMatrix<digits>::absolute() const {
  ExactMatrix out = *this;
  for (Number& entry : out.entries_) entry = abs(entry);
  return out;
}
template <int digits>
bool ExactMatrix<digits>::isZero() const {
  return std::all_of(entries_.begin(), entries_.end(), [](const Number& entry) { return entry == Number(0); });
}
template <int digits>
ExactNumber<digits> ExactMatrix<digits>::dot(const ExactMatrix& x) const {
  assert(size() == x.size());
  return sumOfProducts(data(), 1, x.data(), size());
}
template <int digits>
ExactNumber<digits> ExactMatrix<digits>::trace() const {
  assert(rows_ == cols_);
  Number sum;
  for (Index k = 0; k < rows_; ++k) sum += (*this)(k, k);
  return sum;
}
template <int digits>
std::vector<long double> ExactMatrix<digits>::rounded() const {
  std::vector<long double> out;
  for (Index i = 0; i < rows_; ++i)
    for (Index j = 0; j < cols_; ++j) out.push_back(static_cast<long double>((*this)(i, j)));
  return out;
}

template <int digits>
ExactView<digits>& ExactView<digits>::operator=(const Matrix& x) {
  assert(rows_ == x.rows() && cols_ == x.cols());
  eachEntry(first_, rows_, cols_, step_, [&](Number& entry, std::ptrdiff_t k) { entry = x[k]; });
  return *this;
}
template <int digits>
ExactView<digits>& ExactView<digits>::operator+=(const Matrix& x) {
  assert(rows_ == x.rows() && cols_ == x.cols());
  eachEntry(first_, rows_, cols_, step_, [&](Number& entry, std::ptrdiff_t k) { entry += x[k]; });
  return *this;
}
template <int digits>
ExactView<digits>& ExactView<digits>::operator-=(const Matrix& x) {
  assert(rows_ == x.rows() && cols_ == x.cols());
  eachEntry(first_, rows_, cols_, step_, [&](Number& entry, std::ptrdiff_t k) { entry -= x[k]; });
  return *this;
}
template <int digits>
ExactView<digits>::operator Matrix() const {
  Matrix out(rows_, cols_);
  eachEntry(first_, rows_, cols_, step_, [&](Number& entry, std::ptrdiff_t k) { out[k] = entry; });
  return out;
}

template class ExactMatrix<50>;
template class ExactMatrix<100>;
template class ExactView<50>;
template class ExactView<100>;

}  // namespace dyn::tool
