// Between columns of numbers, a state each, and packs, whose lanes are states.
#pragma once

#include <dyn/scalar/select.hpp>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

namespace dyn::kernels {

/// Turns a square of numbers, as many rows as a pack has lanes, in registers: each round interleaves the two halves of the rows.
/// Written with the compilers' own vectors, which name no instruction set.
template <class T, int lanes>
struct Square {
  typedef T Row __attribute__((vector_size(sizeof(T) * lanes)));  // gcc 12 forgets the attribute of an alias
  Row rows[lanes];

  Row& operator[](int i) { return rows[i]; }
  void read(int i, const T* from) { std::memcpy(&rows[i], from, sizeof(Row)); }
  void write(int i, T* to) const { std::memcpy(to, &rows[i], sizeof(Row)); }
  void transpose() {
    for (int round = 1; round < lanes; round *= 2) {
      Square next;
      for (int i = 0; i < lanes / 2; ++i) {
        next[2 * i] = interleaved<0>(rows[i], rows[i + lanes / 2], std::make_integer_sequence<int, lanes>());
        next[2 * i + 1] = interleaved<lanes / 2>(rows[i], rows[i + lanes / 2], std::make_integer_sequence<int, lanes>());
      }
      *this = next;
    }
  }

 private:
  template <int first, int... k>
  static Row interleaved(const Row& a, const Row& b, std::integer_sequence<int, k...>) {
    return __builtin_shufflevector(a, b, (first + k / 2 + (k % 2) * lanes)...);
  }
};

/// Columns of the caller's; null ones count as zeros.
template <class T>
struct ColumnsIn {
  const T* first = nullptr;
  std::ptrdiff_t stride = 0;
  int states = 0;     ///< columns in use, at most as many as a pack has lanes; the other lanes repeat the last
  bool more = false;  ///< another column follows these, so that reading past the end of the last one stays in the caller's memory
};

/// n numbers of each column into packs.
template <class S, class T>
void loadColumns(const ColumnsIn<T>& in, int n, S* to) {
  constexpr int lanes = lanes_of<S>;
  if (in.first == nullptr) {
    std::fill(to, to + n, S(0));
    return;
  }
  const auto column = [&](int l) { return in.first + std::min(l, in.states - 1) * in.stride; };
  T* out = reinterpret_cast<T*>(to);
  if constexpr (lanes > 1) {
    Square<T, lanes> square;
    if (n >= lanes) {
      // The last square overlaps the one before.
      for (int row = 0; row < n; row += lanes) {
        const int top = std::min(row, n - lanes);
        for (int l = 0; l < lanes; ++l) square.read(l, column(l) + top);
        square.transpose();
        for (int i = 0; i < lanes; ++i) square.write(i, out + (top + i) * lanes);
      }
      return;
    }
    if (2 * n >= lanes) {
      // Short columns are read past their end, into the next one; the last, which may have none, is copied.
      T last[lanes] = {};
      std::copy_n(column(in.states - 1), n, last);
      for (int l = 0; l < lanes; ++l) square.read(l, l + 1 < in.states || in.more ? column(l) : last);
      square.transpose();
      for (int i = 0; i < n; ++i) square.write(i, out + i * lanes);
      return;
    }
  }
  for (int l = 0; l < lanes; ++l) {
    const T* from = column(l);
    for (int i = 0; i < n; ++i) out[i * lanes + l] = from[i];
  }
}

/// The way back: n numbers of each of the first `states` lanes into columns that follow one another, n apart.
template <class S, class T>
void storeColumns(const S* from, std::ptrdiff_t n, int states, T* column) {
  constexpr int lanes = lanes_of<S>;
  const T* in = reinterpret_cast<const T*>(from);
  if constexpr (lanes > 1) {
    if (n >= lanes) {
      Square<T, lanes> square;
      for (std::ptrdiff_t row = 0; row < n; row += lanes) {
        const std::ptrdiff_t top = std::min<std::ptrdiff_t>(row, n - lanes);
        for (int i = 0; i < lanes; ++i) square.read(i, in + (top + i) * lanes);
        square.transpose();
        for (int l = 0; l < states; ++l) square.write(l, column + l * n + top);
      }
      return;
    }
    if (2 * n >= lanes) {
      // Each column but the last is written past its end, where the next one will be.
      Square<T, lanes> square;
      for (int i = 0; i < lanes; ++i) square.read(i, in + std::min<std::ptrdiff_t>(i, n - 1) * lanes);
      square.transpose();
      for (int l = 0; l + 1 < states; ++l) square.write(l, column + l * n);
      T last[lanes];
      square.write(states - 1, last);
      std::copy_n(last, n, column + (states - 1) * n);
      return;
    }
  }
  for (int l = 0; l < states; ++l)
    for (std::ptrdiff_t i = 0; i < n; ++i) column[l * n + i] = in[i * lanes + l];
}

}  // namespace dyn::kernels
