// SPDX-License-Identifier: BSD-2-Clause
// Vectors and matrices cross the library's boundary as pointers with sizes. No Eigen object crosses it, so compiler flags never matter.
#pragma once

#include <Eigen/Core>

#include <concepts>
#include <cstddef>
#include <type_traits>

namespace dyn {

/// A view of contiguous numbers that somebody else owns.
struct VectorView {
  const double* data = nullptr;  ///< the first number
  std::ptrdiff_t size = 0;       ///< how many there are
};

/// An argument of an algorithm: any Eigen vector expression, or a pointer with a size. Contiguous vectors are passed as they are. Other
/// expressions are evaluated into a temporary on the caller's side; this allocates, so pass a vector in real-time loops.
class VectorArg {
 public:
  /// Refers to `size` numbers, or to a contiguous Eigen vector; other expressions are evaluated into a temporary.
  /// @{
  VectorArg(const double* data, std::ptrdiff_t size) : view_{data, size} {}
  template <class Derived>
  VectorArg(const Eigen::DenseBase<Derived>& x) {  // NOLINT: meant to convert
    constexpr bool direct =
        (Derived::Flags & Eigen::DirectAccessBit) && int(Derived::InnerStrideAtCompileTime) == 1 && (int(Derived::IsVectorAtCompileTime));
    if constexpr (direct) {
      view_ = {x.derived().data(), x.size()};
    } else {
      copy_ = x.derived().template cast<double>();
      view_ = {copy_.data(), copy_.size()};
    }
  }
  /// @}
  VectorArg(const VectorArg&) = delete;
  VectorArg& operator=(const VectorArg&) = delete;
  /// Returns a view that is valid as long as this argument.
  operator VectorView() const { return view_; }  // NOLINT

 private:
  VectorView view_;
  Eigen::VectorXd copy_;
};

namespace detail {
/// A type to which results may be written: its numbers are not const, and it is no temporary vector or matrix. A temporary Map or block is allowed.
template <class T>
concept Writable = requires(T& x) {
  { x.data() } -> std::same_as<double*>;
  x.outerStride();
} && !(std::is_rvalue_reference_v<T&&> && std::is_base_of_v<Eigen::PlainObjectBase<std::remove_cvref_t<T>>, std::remove_cvref_t<T>>);
}  // namespace detail

/// The caller's vector for a result: a vector, a segment of one, a column, a Map, or a pointer with a size.
class VectorOut {
 public:
  /// Refers to `size` numbers, or to a contiguous Eigen vector of doubles.
  /// @{
  VectorOut(double* data, std::ptrdiff_t size) : data_(data), size_(size) {}
  template <detail::Writable T>
  VectorOut(T&& x) : data_(x.data()), size_(x.size()) {  // NOLINT: meant to convert
    using Plain = std::remove_cvref_t<T>;
    static_assert(int(Plain::IsVectorAtCompileTime), "a vector");
    static_assert(int(Plain::InnerStrideAtCompileTime) == 1, "entries must follow one another");
  }
  /// @}
  double* data() const { return data_; }         ///< the first number
  std::ptrdiff_t size() const { return size_; }  ///< how many there are

 private:
  double* data_;
  std::ptrdiff_t size_;
};

/// The caller's matrix for a result: a column-major matrix, or a block of one.
class MatrixOut {
 public:
  /// Refers to a column-major matrix whose columns begin `stride` numbers apart (`rows` if it is left out), or to an Eigen matrix of doubles.
  /// @{
  MatrixOut(double* data, std::ptrdiff_t rows, std::ptrdiff_t cols) : MatrixOut(data, rows, cols, rows) {}
  MatrixOut(double* data, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t stride) : data_(data), rows_(rows), cols_(cols), stride_(stride) {}
  template <detail::Writable T>
  MatrixOut(T&& x) : MatrixOut(x.data(), x.rows(), x.cols(), x.outerStride()) {  // NOLINT: meant to convert
    using Plain = std::remove_cvref_t<T>;
    static_assert(!Plain::IsRowMajor, "results are written column after column");
    static_assert(int(Plain::InnerStrideAtCompileTime) == 1, "entries of a column must follow one another");
  }
  /// @}
  double* column(std::ptrdiff_t k) const { return data_ + k * stride_; }  ///< first number of column k
  std::ptrdiff_t rows() const { return rows_; }                           ///< number of rows
  std::ptrdiff_t cols() const { return cols_; }                           ///< number of columns
  std::ptrdiff_t stride() const { return stride_; }                       ///< numbers from one column to the next

 private:
  double* data_;
  std::ptrdiff_t rows_, cols_, stride_;
};

/// Results are views of memory that the Data owns. The views are valid until the Data is destroyed, and the next call overwrites them. q, v, a and
/// tau of that call may be such views (`aba(model, data, q, v, rnea(model, data, q, v, a))`), because they are read before anything is written.
/// @{
using VectorResult = Eigen::Map<const Eigen::VectorXd>;
using MatrixResult = Eigen::Map<const Eigen::MatrixXd>;
/// @}

}  // namespace dyn
