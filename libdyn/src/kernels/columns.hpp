// Between columns of numbers, a state each, and packs, whose lanes are states.
#pragma once

#include <dyn/scalar/select.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace dyn::kernels {

/// Turns a square of numbers, as many rows as a pack has lanes, in registers: each round exchanges blocks beside the diagonal, of one number,
/// of two, and so on. Written with the compilers' own vectors, which name no instruction set. Of half as many rows it is two squares side by side.
template <class T, int lanes, int height = lanes>
struct Square {
  typedef T Row __attribute__((vector_size(sizeof(T) * lanes)));  // gcc 12 forgets the attribute of an alias
  // In memory. Not copied as bytes, which gcc 12 does by halves, that the whole is then read from right after.
  typedef T Unaligned __attribute__((vector_size(sizeof(T) * lanes), aligned(alignof(T))));
  typedef T Part __attribute__((vector_size(sizeof(T) * height), aligned(alignof(T))));
  Row rows[height];

  void read(int i, const T* from) { rows[i] = *reinterpret_cast<const Unaligned*>(from); }
  void write(int i, T* to) const { *reinterpret_cast<Unaligned*>(to) = rows[i]; }
  /// Rows `stride` apart.
  void read(const T* from, std::ptrdiff_t stride) {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) read(i, from + i * stride);
  }
  void write(T* to, std::ptrdiff_t stride) const {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) write(i, to + i * stride);
  }
  /// The first n rows. Row by row: a loop over them is made a copy of bytes.
  void writeSome(std::ptrdiff_t n, T* to) const {
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i)
      if (i < n) write(i, to + i * lanes);
  }
  /// Between rows of the squares and columns, of which there are as many as lanes: `height` numbers of each.
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
  /// The lower half of a row, or the upper one.
  template <int which>
  static auto half(const Row& row) {
    return [&]<int... k>(std::integer_sequence<int, k...>) {
      return __builtin_shufflevector(row, row, (which * (lanes / 2) + k)...);
    }(std::make_integer_sequence<int, lanes / 2>());
  }
  void transpose() { exchangeFrom<1>(); }
  /// Takes another's numbers k of each row beyond k.
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
  /// Rounds of blocks of `d` numbers and more.
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

/// The first `count` numbers of a row, or all: by halves.
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

/// Structs of `numbers` numbers S, at least as many as Wide has lanes, each into a lane; from[l] is the first number of lane l's.
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

/// Columns of the caller's; null ones count as zeros.
template <class T>
struct ColumnsIn {
  const T* first = nullptr;
  std::ptrdiff_t stride = 0;
  int states = 0;     ///< columns in use, at most as many as a pack has lanes; the other lanes repeat the last
  int following = 0;  ///< columns after these: reading past the end of a column, into the next ones, stays in the caller's memory
};

/// Calls use(height), a constant: of squares that take columns of n numbers, fewer than there are lanes.
template <int lanes, class Use>
decltype(auto) withHeight(std::ptrdiff_t n, Use&& use) {
  if constexpr (lanes >= 8)
    if (2 * n <= lanes) return use(std::integral_constant<int, lanes / 2>());
  return use(std::integral_constant<int, lanes>());
}

/// Columns of n numbers, at most as many as squares are high: they are read past their end, into the next ones; those where these are too few
/// before `end` are copied.
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

/// n numbers of each column into packs.
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

/// Packs turned into numbers of one state after the other, `lanes` of each, and whether all of them are finite.
template <class T, int lanes>
class PackTurner {
 public:
  /// Packs, the i-th at from(i).
  template <int height = lanes, class From>
  Square<T, lanes, height> turned(const From& from) {
    Square<T, lanes, height> square;
#pragma GCC unroll 16
    for (int i = 0; i < height; ++i) square.read(i, from(i));
    // Apart from the squares before, so that each need not wait for them.
    auto zeros = T(0) * square.rows[0];
#pragma GCC unroll 16
    for (int i = 1; i < height; ++i) zeros += T(0) * square.rows[i];
    zeros_ += zeros;
    square.transpose();
    return square;
  }
  /// As many packs to each of the first `states` columns, from `row` on; a constant where all are in use. Cores write in order, and wait for one line
  /// of memory after the other: those where a square ends are asked for first, which makes it 1.5 times as fast where a square has much of a line.
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
  /// 0 x is zero for finite numbers, and NaN for all others.
  bool finite() const {
    bool all = true;
    for (int l = 0; l < lanes; ++l) all = all && zeros_[l] == T(0);
    return all;
  }

 private:
  typename Square<T, lanes>::Row zeros_{};
};

/// Squares of packs, which from(k)(i) tells of, k < count, to where begin(k) says in states' columns. Whether all are finite. Not inlined: it wants
/// all registers.
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

/// n packs, at most as many as squares are high, to columns that follow one another. Those are written past their ends, where the next ones will
/// be; the last, where these are too few, are copied. Whether all numbers are finite.
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

/// The way back: n numbers of each of the first `states` lanes into columns that follow one another, `stride` apart. Whether all are finite.
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
