// SPDX-License-Identifier: BSD-2-Clause
// Arguments with many states, one a column.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <type_traits>

namespace dyn::detail {

/// Columns of numbers that somebody else owns.
template <class T>
struct StatesView {
  const T* data = nullptr;
  std::ptrdiff_t rows = 0, cols = 0, stride = 0;
  bool given = false;  ///< true for an argument, even for one without numbers
};

/// An argument: a column-major matrix, a block of columns, or a Map. Its numbers are not copied.
template <class T>
class StatesArg {
 public:
  template <class Derived>
  StatesArg(const Eigen::DenseBase<Derived>& x)  // NOLINT: meant to convert
      : view_{x.derived().data(), x.rows(), x.cols(), one_row<Derived> ? 1 : x.derived().outerStride(), true} {
    static_assert(std::is_same_v<typename Derived::Scalar, T>, "the batch computes in another number type");
    static_assert(!Derived::IsRowMajor || int(Derived::ColsAtCompileTime) == 1 || one_row<Derived>, "columns are states: a column-major matrix");
    static_assert(int(Derived::InnerStrideAtCompileTime) == 1, "the numbers of a state must follow one another");
  }
  StatesArg(const StatesView<T>& x) : view_(x) {}   // NOLINT: meant to convert
  operator StatesView<T>() const { return view_; }  // NOLINT

 private:
  template <class Derived>
  static constexpr bool one_row = Derived::IsRowMajor && int(Derived::RowsAtCompileTime) == 1;  // its numbers are columns

  StatesView<T> view_;
};

}  // namespace dyn::detail
