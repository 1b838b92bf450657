// SPDX-License-Identifier: BSD-2-Clause
// Transposes columns of numbers, one column per state, into packs whose lanes are states, and back.
#pragma once

#include <dyn/scalar/select.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace dyn::kernels {

/// Transposes a square of numbers in registers. A square has as many rows as a pack has lanes; each round exchanges off-diagonal blocks of one
/// number, of two numbers, and so on. With half as many rows, the object is two squares side by side. The code uses the compilers' own vectors,
/// which name no instruction set.
template <class T, int lanes, int height = lanes>
struct Square {
  typedef T Row __attribute__((vector_size(sizeof(T) * lanes)));  // gcc 12 forgets the attribute of an alias
  // A row in memory. It is not copied as bytes: gcc 12 copies them in two halves, and reading the whole row right after that is slow.
  typedef T Unaligned __attribute__((vector_size(sizeof(T) * lanes), aligned(alignof(T))));
  typedef T Part __attribute__((vector_size(sizeof(T) * height), aligned(alignof(T))));
  Row rows[height];

  void read(int i, const T* from) { rows[i] = *reinterpret_cast<const Unaligned*>(from); }
  void write(int i, T* to) const { *reinterpret_cast<Unaligned*>(to) = rows[i]; }
  /// Reads or writes all rows, which lie `stride` apart.
  void read(const T* from, std::ptrdiff_t stride) {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) read(i, from + i * stride);
  }
  void write(T* to, std::ptrdiff_t stride) const {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) write(i, to + i * stride);
  }
  /// Writes the first n rows. Each row is a separate case, because compilers turn a loop over rows into a copy of bytes.
  void writeSome(std::ptrdiff_t n, T* to) const {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i)
      if (i < n) write(i, to + i * lanes);
  }
  /// Reads `height` numbers of each column into one row of a square. There are as many columns as lanes. writeColumn() writes such a row.
  void readColumns(const T* const* columns) {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) {
      if constexpr (height == lanes) {
        read(i, columns[i]);
      } else {
        rows[i] = [&]<int... k>(std::integer_sequence<int, k...>) {
          return __builtin_shufflevector(*reinterpret_cast<const Part*>(columns[i]), *reinterpret_cast<const Part*>(columns[height + i]), k...);
        }(std::make_integer_sequence<int, lanes>());
      }
    }
  }
  void writeColumn(int l, T* to) const {
    if constexpr (height == lanes) {
      write(l, to);
    } else {
      const Row& row = rows[l % height];
      *reinterpret_cast<Part*>(to) = l < height ? half<0>(row) : half<1>(row);
    }
  }
  /// The lower half of a row (which = 0), or the upper half (which = 1).
  template <int which>
  static auto half(const Row& row) {
    return [&]<int... k>(std::integer_sequence<int, k...>) {
      return __builtin_shufflevector(row, row, (which * (lanes / 2) + k)...);
    }(std::make_integer_sequence<int, lanes / 2>());
  }
  void transpose() { exchangeFrom<1>(); }
  /// Takes the numbers k < row of each row from `other`. If the rows are columns of a matrix, these are the entries above its diagonal.
  void replaceAbove(const Square& other) {
    [&]<int... row>(std::integer_sequence<int, row...>) {
      (replaceBefore<row>(other, std::make_integer_sequence<int, lanes>()), ...);
    }(std::make_integer_sequence<int, lanes>());
  }

 private:
  template <int row, int... k>
  void replaceBefore(const Square& other, std::integer_sequence<int, k...>) {
    rows[row] = __builtin_shufflevector(rows[row], other.rows[row], (k < row ? lanes + k : k)...);
  }
  /// Does the rounds that exchange blocks of `d` numbers and more.
  template <int d>
  void exchangeFrom() {
    if constexpr (d < height) {
#pragma GCC unroll 16
      for (int i = 0; i < height / 2; ++i) {
        const int row = i / d * 2 * d + i % d;
        exchange<d>(rows[row], rows[row + d], std::make_integer_sequence<int, lanes>());
      }
      exchangeFrom<2 * d>();
    }
  }
  /// Exchanges the odd blocks of `a` with the even ones of `b`.
  template <int d, int... k>
  static void exchange(Row& a, Row& b, std::integer_sequence<int, k...>) {
    const Row even = __builtin_shufflevector(a, b, (k & d ? lanes + k - d : k)...);
    b = __builtin_shufflevector(a, b, (k & d ? lanes + k : (k + d) % lanes)...);
    a = even;
  }
};

/// Stores the first `count` numbers of a row, or all if there are fewer. It proceeds by halves.
template <int lanes>
void storeFirst(const typename Square<double, lanes>::Row& x, int count, double* to) {
  if (count >= lanes) {
    *reinterpret_cast<typename Square<double, lanes>::Unaligned*>(to) = x;
  } else if constexpr (lanes > 1) {
    constexpr int half = lanes / 2;
    using Whole = Square<double, lanes>;
    storeFirst<half>(Whole::template half<0>(x), count, to);
    if (count > half) storeFirst<half>(Whole::template half<1>(x), count - half, to + half);
  }
}

/// Gathers structs of `numbers` numbers S, one struct into each lane; from[l] points at the first number for lane l. A struct has at least as many
/// numbers as Wide has lanes.
template <int numbers, class Wide, class S>
void gatherStructs(const S* const* from, Wide* to) {
  constexpr int lanes = lanes_of<Wide>;
  S* out = reinterpret_cast<S*>(to);
  Square<S, lanes> square;
#pragma GCC unroll 16
  for (int k = 0; k < numbers; k += lanes) {
    // The last square overlaps the one before.
    const int first = std::min(k, numbers - lanes);
#pragma GCC unroll 16
    for (int l = 0; l < lanes; ++l) square.read(l, from[l] + first);
    square.transpose();
    square.write(out + first * lanes, lanes);
  }
}

/// Columns in the caller's memory. If `first` is null, all their numbers are zero.
template <class T>
struct ColumnsIn {
  const T* first = nullptr;
  std::ptrdiff_t stride = 0;
  int states = 0;     ///< columns in use, at most as many as a pack has lanes; the other lanes repeat the last
  int following = 0;  ///< columns after these in the caller's memory, so that a read past the end of a column may reach into them
};

/// Calls use(height) with the height, a constant, of squares that take columns of n numbers. n is smaller than the number of lanes.
template <int lanes, class Use>
decltype(auto) withHeight(std::ptrdiff_t n, Use&& use) {
  if constexpr (lanes >= 8)
    if (2 * n <= lanes) return use(std::integral_constant<int, lanes / 2>());
  return use(std::integral_constant<int, lanes>());
}

/// Loads columns of n <= `height` numbers. It reads past the end of a column, into the next ones. Columns with fewer than `height` numbers before
/// `end` are copied first.
template <class T, int lanes, int height>
[[gnu::always_inline]] inline void loadShort(const T* (&columns)[lanes], std::ptrdiff_t n, const T* end, T* to) {
  T copied[lanes][height];
  if (end - columns[lanes - 1] < height) {
    std::fill_n(copied[0], lanes * height, T(0));
    for (int l = 0; l < lanes; ++l)
      if (end - columns[l] < height) columns[l] = (std::copy_n(columns[l], n, copied[l]), copied[l]);
  }
  Square<T, lanes, height> square;
  square.readColumns(columns);
  square.transpose();
  square.writeSome(n, to);
}

/// Loads n numbers of each column into packs.
template <class S, class T>
void loadColumns(const ColumnsIn<T>& in, std::ptrdiff_t n, S* to) {
  constexpr int lanes = lanes_of<S>;
  if (in.first == nullptr) {
    std::fill(to, to + n, S(0));
    return;
  }
  const T* columns[lanes]{in.first};
#pragma GCC unroll 16
  for (int l = 1; l < lanes; ++l) columns[l] = columns[l - 1] + (l < in.states ? in.stride : 0);
  T* out = reinterpret_cast<T*>(to);
  if constexpr (lanes > 1) {
    if (n >= lanes) {
      Square<T, lanes> square;
      // The last square overlaps the one before.
      for (std::ptrdiff_t row = 0; row < n; row += lanes) {
        const std::ptrdiff_t top = std::min(row, n - lanes);
#pragma GCC unroll 16
        for (int l = 0; l < lanes; ++l) square.read(l, columns[l] + top);
        square.transpose();
        square.write(out + top * lanes, lanes);
      }
      return;
    }
    if (4 * n >= lanes) {
      const T* end = in.first + (in.states - 1 + in.following) * in.stride + n;
      return withHeight<lanes>(n, [&](auto height) { loadShort<T, lanes, height>(columns, n, end, out); });
    }
  }
  for (int l = 0; l < lanes; ++l)
    for (std::ptrdiff_t i = 0; i < n; ++i) out[i * lanes + l] = columns[l][i];
}

/// Transposes packs into `lanes` numbers of each state, and records whether all of them are finite.
template <class T, int lanes>
class PackTurner {
 public:
  /// Transposes packs, the i-th of which lies at from(i).
  template <int height = lanes, class From>
  Square<T, lanes, height> turned(const From& from) {
    Square<T, lanes, height> square;
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) square.read(i, from(i));
    // This sum is separate from those of earlier squares, so that no square waits for them.
    auto zeros = T(0) * square.rows[0];
#pragma GCC unroll 16
    for (int i = 1; i < height; ++i) zeros += T(0) * square.rows[i];
    zeros_ += zeros;
    square.transpose();
    return square;
  }
  /// Writes `lanes` packs to the first `states` columns, from `row` on. `states` is a constant where all columns are in use. Cores write in order and
  /// wait for one cache line after the other. Prefetching the lines where a square ends is 1.5 times as fast where a square fills much of a line.
  template <class From, class Count>
  void put(const From& from, Count states, T* const (&columns)[lanes], std::ptrdiff_t row) {
    if constexpr (lanes * sizeof(T) >= 32) {
#pragma GCC unroll 16
      for (int l = 0; l < lanes; ++l)
        if (l < states) __builtin_prefetch(columns[l] + row + lanes - 1, 1);
    }
    const Square<T, lanes> square = turned(from);
#pragma GCC unroll 16
    for (int l = 0; l < lanes; ++l)
      if (l < states) square.write(l, columns[l] + row);
  }
  /// Whether all numbers were finite: 0 x is zero for finite numbers and NaN for all others.
  bool finite() const {
    bool all = true;
    for (int l = 0; l < lanes; ++l) all = all && zeros_[l] == T(0);
    return all;
  }

 private:
  typename Square<T, lanes>::Row zeros_{};
};

/// Writes `count` squares of packs to the states' columns. Pack i of square k lies at from(k)(i); the square goes to the rows from begin(k) on.
/// Returns whether all numbers are finite. The function is not inlined, because it needs all registers.
template <class T, int lanes, class Begin, class From>
[[nodiscard, gnu::noinline]] bool putSquares(std::ptrdiff_t count, Begin begin, From from, int states, T* column, std::ptrdiff_t stride) {
  PackTurner<T, lanes> turner;
  T* columns[lanes];
#pragma GCC unroll 16
  for (int l = 0; l < lanes; ++l) columns[l] = column + l * stride;
  const auto putAll = [&](auto in_use) __attribute__((always_inline)) {
    for (std::ptrdiff_t k = 0; k < count; ++k) turner.put(from(k), in_use, columns, begin(k));
  };
  if (states == lanes) {
    putAll(std::integral_constant<int, lanes>());
  } else {
    putAll(states);
  }
  return turner.finite();
}

/// Stores n <= `height` packs into columns that follow one another. It writes past the end of a column, into the next ones, which it writes later.
/// The last columns, where too few numbers follow, are copied. Returns whether all numbers are finite.
template <class T, int lanes, int height>
[[nodiscard]] bool storeShort(const T* numbers, int n, int states, T* column) {
  PackTurner<T, lanes> turner;
  const auto square = turner.template turned<height>([=](int i) { return numbers + std::min(i, n - 1) * lanes; });
  const int whole = states - (height - 1) / n;
#pragma GCC unroll 16
  for (int l = 0; l < lanes; ++l)
    if (l < whole) square.writeColumn(l, column + l * n);
  T copied[lanes][height];
#pragma GCC unroll 16
  for (int l = 0; l < lanes; ++l)
    if (l >= whole) square.writeColumn(l, copied[l]);
  for (int l = std::max(whole, 0); l < states; ++l) std::copy_n(copied[l], n, column + l * n);
  return turner.finite();
}

/// The inverse of loadColumns: stores n numbers of each of the first `states` lanes into columns `stride` apart. Returns whether all are finite.
template <class S, class T>
[[nodiscard]] bool storeColumns(const S* packs, std::ptrdiff_t n, int states, T* column, std::ptrdiff_t stride) {
  constexpr int lanes = lanes_of<S>;
  const auto* numbers = reinterpret_cast<const T*>(packs);
  if constexpr (lanes > 1) {
    if (n >= lanes) {
      const auto begin = [n](std::ptrdiff_t k) { return std::min<std::ptrdiff_t>(k * lanes, n - lanes); };
      const auto from = [=](std::ptrdiff_t k) { return [square = numbers + begin(k) * lanes](int i) { return square + i * lanes_of<S>; }; };
      return putSquares<T, lanes>((n + lanes - 1) / lanes, begin, from, states, column, stride);
    }
    if (stride == n && 4 * n >= lanes)
      return withHeight<lanes>(n, [&](auto height) { return storeShort<T, lanes, height>(numbers, static_cast<int>(n), states, column); });
  }
  T differences(0);
  for (std::ptrdiff_t i = 0; i < n; ++i, numbers += lanes) {
    for (int l = 0; l < states; ++l) {
      column[l * stride + i] = numbers[l];
      differences += numbers[l] - numbers[l];
    }
  }
  return differences == T(0);
}

}  // namespace dyn::kernels
