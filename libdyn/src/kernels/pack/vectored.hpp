// SPDX-License-Identifier: BSD-2-Clause
// Three-vectors and 3x3 matrices in registers, for a single state that is computed body by body. There neither joints nor states fill the lanes.
//
// Vectored is a number like double. A vector of it has its coordinates in the lanes of one register of four, and a matrix has its columns in three
// registers. The recursions are written for any scalar, so they compute with three numbers at once. The fourth lane has no meaning.
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/pack/lanes.hpp"

#include <dyn/scalar/select.hpp>
#include <dyn/spatial/inertia.hpp>

#include <cmath>

namespace dyn {

struct Vectored {
  double x;
  Vectored() = default;
  Vectored(double number) : x(number) {}  // NOLINT: a number
  /// Only lvalues can be assigned to, because the coordinates that a vector returns are copies.
  Vectored(const Vectored&) = default;
  Vectored& operator=(const Vectored&) & = default;

  friend Vectored operator+(const Vectored& a, const Vectored& b) { return a.x + b.x; }
  friend Vectored operator-(const Vectored& a, const Vectored& b) { return a.x - b.x; }
  friend Vectored operator-(const Vectored& a) { return -a.x; }
  friend Vectored operator*(const Vectored& a, const Vectored& b) { return a.x * b.x; }
  friend Vectored operator/(const Vectored& a, const Vectored& b) { return a.x / b.x; }
  Vectored& operator+=(const Vectored& b) & { return *this = *this + b; }
  Vectored& operator-=(const Vectored& b) & { return *this = *this - b; }

  friend bool operator>(const Vectored& a, const Vectored& b) { return a.x > b.x; }
  friend bool operator<=(const Vectored& a, const Vectored& b) { return a.x <= b.x; }
  friend bool operator==(const Vectored& a, const Vectored& b) { return a.x == b.x; }
};

template <>
struct RealOf<Vectored> {
  using type = double;
  static constexpr int lanes = 1;
};

inline Vec4d inAll(const Vectored& s) { return Vec4d{s.x, s.x, s.x, s.x}; }
/// Copies one lane to all lanes.
template <int lane>
Vec4d inAll(const Vec4d& a) {
  return __builtin_shufflevector(a, a, lane, lane, lane, lane);
}
/// (y, z, x).
inline Vec4d turned(const Vec4d& a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }
/// (z, x, y).
inline Vec4d turnedBack(const Vec4d& a) { return __builtin_shufflevector(a, a, 2, 0, 1, 3); }
inline Vectored sumOf(const Vec4d& a) { return a[0] + a[1] + a[2]; }
/// The sum of a vector's coordinates, and the dot product of two vectors, each in all three lanes.
inline Vec4d totalInAll(const Vec4d& a) {
  const Vec4d next = turned(a);
  return a + next + turned(next);
}
inline Vec4d dotInAll(const Vec4d& a, const Vec4d& b) { return totalInAll(a * b); }

template <>
struct Vec3<Vectored> {
  Vec4d a{};

  Vec3() = default;
  Vec3(const Vec4d& lanes) : a(lanes) {}  // NOLINT
  Vec3(const Vec3& other) : a(other.a) {}
  Vec3& operator=(const Vec3& other) {
    a = other.a;
    return *this;
  }
  Vec3(const Vectored& x, const Vectored& y, const Vectored& z) : a{x.x, y.x, z.x, 0} {}
  Vectored operator[](int i) const { return a[i]; }

  friend Vec3 operator+(const Vec3& p, const Vec3& q) { return p.a + q.a; }
  friend Vec3 operator-(const Vec3& p, const Vec3& q) { return p.a - q.a; }
  friend Vec3 operator-(const Vec3& p) { return -p.a; }
  friend Vec3 operator*(const Vectored& s, const Vec3& p) { return inAll(s) * p.a; }
  Vec3& operator+=(const Vec3& q) { return *this = *this + q; }
  Vec3& operator-=(const Vec3& q) { return *this = *this - q; }
};

/// Adds x to coordinate k, and zeros to the others: extracting one coordinate and inserting it again is slow.
inline void addAt(Vec3<Vectored>& v, int k, const Vectored& x) {
  Vec4d added{};
  added[k] = x.x;
  v.a += added;
}

inline Vectored dot(const Vec3<Vectored>& p, const Vec3<Vectored>& q) { return sumOf(p.a * q.a); }
inline Vectored dot(const Motion<Vectored>& m, const Force<Vectored>& f) { return sumOf(m.linear.a * f.linear.a + m.angular.a * f.angular.a); }
inline Vec3<Vectored> cross(const Vec3<Vectored>& p, const Vec3<Vectored>& q) { return turned(p.a * turned(q.a) - turned(p.a) * q.a); }

/// The columns of a 3x3 matrix. They are copied one by one: a copy in blocks of another size than that of the writes would stall the core.
struct Columns {
  Vec4d c[3]{};

  Columns() = default;
  Columns(const Vec4d& x, const Vec4d& y, const Vec4d& z) : c{x, y, z} {}
  Columns(const Columns& other) : Columns(other.c[0], other.c[1], other.c[2]) {}
  Columns& operator=(const Columns& other) {  // NOLINT: self-assignment is harmless
    for (int i = 0; i < 3; ++i) c[i] = other.c[i];
    return *this;
  }
};
/// M v, from the columns of M.
inline Vec4d timesVector(const Vec4d* columns, const Vec4d& v) {
  return columns[0] * inAll<0>(v) + columns[1] * inAll<1>(v) + columns[2] * inAll<2>(v);
}

template <>
struct Mat3<Vectored> : Columns {
  using Columns::Columns;
  static Mat3 identity() { return {Vec4d{1, 0, 0, 0}, Vec4d{0, 1, 0, 0}, Vec4d{0, 0, 1, 0}}; }
  Vec3<Vectored> col(int i) const { return c[i]; }
  Vec3<Vectored> row(int i) const { return {c[0][i], c[1][i], c[2][i]}; }

  friend Vec3<Vectored> operator*(const Mat3& m, const Vec3<Vectored>& v) { return timesVector(m.c, v.a); }
  friend Mat3 operator*(const Mat3& m, const Mat3& n) { return {timesVector(m.c, n.c[0]), timesVector(m.c, n.c[1]), timesVector(m.c, n.c[2])}; }
  friend Mat3 operator+(const Mat3& m, const Mat3& n) { return {m.c[0] + n.c[0], m.c[1] + n.c[1], m.c[2] + n.c[2]}; }
  Mat3& operator+=(const Mat3& n) { return *this = *this + n; }
  friend Mat3 operator-(const Mat3& m, const Mat3& n) { return {m.c[0] - n.c[0], m.c[1] - n.c[1], m.c[2] - n.c[2]}; }
  friend Mat3 operator*(const Vectored& s, const Mat3& m) { return {inAll(s) * m.c[0], inAll(s) * m.c[1], inAll(s) * m.c[2]}; }
};
inline Mat3<Vectored> skew(const Vec3<Vectored>& v) {
  const Vec4d zero{};
  return {__builtin_shufflevector(v.a, zero, 4, 2, 1, 4) * Vec4d{0, 1, -1, 0}, __builtin_shufflevector(v.a, zero, 2, 4, 0, 4) * Vec4d{-1, 0, 1, 0},
          __builtin_shufflevector(v.a, zero, 1, 0, 4, 4) * Vec4d{1, -1, 0, 0}};
}
/// a b^T.
inline Mat3<Vectored> outer(const Vec3<Vectored>& a, const Vec3<Vectored>& b) {
  return {a.a * inAll<0>(b.a), a.a * inAll<1>(b.a), a.a * inAll<2>(b.a)};
}

/// M [r]x.
inline Mat3<Vectored> timesSkew(const Mat3<Vectored>& M, const Vec3<Vectored>& r) {
  const Vec4d x = inAll<0>(r.a), y = inAll<1>(r.a), z = inAll<2>(r.a);
  return {M.c[1] * z - M.c[2] * y, M.c[2] * x - M.c[0] * z, M.c[0] * y - M.c[1] * x};
}
/// [w]x M. Unlike cross(), it does not permute the result, which would be the last step to wait for.
inline Mat3<Vectored> crossColumns(const Vec3<Vectored>& w, const Mat3<Vectored>& M) {
  const Vec4d next = turned(w.a), last = turnedBack(w.a);
  const auto column = [&](const Vec4d& c) { return next * turnedBack(c) - last * turned(c); };
  return {column(M.c[0]), column(M.c[1]), column(M.c[2])};
}

/// x columns[0] + y columns[1] + z columns[2].
inline Vec4d timesReal(const Vec4d* columns, double x, double y, double z) {
  return columns[0] * inAll(x) + columns[1] * inAll(y) + columns[2] * inAll(z);
}
inline Vec3<Vectored> operator*(const Mat3<Vectored>& m, const Vec3<double>& v) { return timesReal(m.c, v.x, v.y, v.z); }
inline Mat3<Vectored> operator*(const Mat3<Vectored>& m, const Mat3<double>& n) {
  const auto column = [&](int i) { return timesReal(m.c, n(0, i), n(1, i), n(2, i)); };
  return {column(0), column(1), column(2)};
}
inline Mat3<Vectored> operator*(const Mat3<Vectored>& m, const Sym3<double>& n) {
  return {timesReal(m.c, n.xx, n.xy, n.xz), timesReal(m.c, n.xy, n.yy, n.yz), timesReal(m.c, n.xz, n.yz, n.zz)};
}

inline Vec3<Vectored> crossZ(const Vec3<Vectored>& v, const Vectored& z) {
  return __builtin_shufflevector(v.a, v.a, 1, 0, 2, 3) * Vec4d{z.x, -z.x, 0, 0};
}

inline Mat3<Vectored> transpose(const Mat3<Vectored>& m) {
  const Vec4d &x = m.c[0], &y = m.c[1], &z = m.c[2];
  const Vec4d outer = __builtin_shufflevector(x, y, 0, 4, 2, 6), inner = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  return {__builtin_shufflevector(outer, z, 0, 1, 4, 7), __builtin_shufflevector(inner, z, 0, 1, 5, 7),
          __builtin_shufflevector(outer, z, 2, 3, 6, 7)};
}
inline Vec3<Vectored> transposeTimes(const Mat3<Vectored>& m, const Vec3<Vectored>& v) { return transpose(m) * v; }

/// A symmetric matrix that stores all nine entries, in columns.
template <>
struct Sym3<Vectored> : Columns {
  using Columns::Columns;
  Sym3(const Vectored& xx, const Vectored& xy, const Vectored& xz, const Vectored& yy, const Vectored& yz, const Vectored& zz)
      : Columns(Vec4d{xx.x, xy.x, xz.x, 0}, Vec4d{xy.x, yy.x, yz.x, 0}, Vec4d{xz.x, yz.x, zz.x, 0}) {}
  Mat3<Vectored> matrix() const { return {c[0], c[1], c[2]}; }

  friend Vec3<Vectored> operator*(const Sym3& m, const Vec3<Vectored>& v) { return timesVector(m.c, v.a); }
  friend Sym3 operator+(const Sym3& m, const Sym3& n) { return {m.c[0] + n.c[0], m.c[1] + n.c[1], m.c[2] + n.c[2]}; }
  Sym3& operator+=(const Sym3& n) { return *this = *this + n; }
};

inline Vectored trace(const Mat3<Vectored>& a) { return Vectored(a.c[0][0]) + Vectored(a.c[1][1]) + Vectored(a.c[2][2]); }
inline Vectored trace(const Sym3<Vectored>& a) { return Vectored(a.c[0][0]) + Vectored(a.c[1][1]) + Vectored(a.c[2][2]); }

/// R a R^T.
inline Sym3<Vectored> congruence(const Mat3<Vectored>& R, const Sym3<double>& a) {
  const Mat3<Vectored> turned_columns = R * a;
  const Vec4d* c = turned_columns.c;
  const auto column = [&]<int i>() { return c[0] * inAll<i>(R.c[0]) + c[1] * inAll<i>(R.c[1]) + c[2] * inAll<i>(R.c[2]); };
  return {column.template operator()<0>(), column.template operator()<1>(), column.template operator()<2>()};
}

inline Sym3<Vectored> congruence(const Mat3<Vectored>& R, const Sym3<Vectored>& a) {
  const Mat3<Vectored> product = R * a.matrix() * transpose(R);
  return {product.c[0], product.c[1], product.c[2]};
}
template <>
inline Sym3<double> cast<double, Vectored>(const Sym3<Vectored>& a) {
  return {a.c[0][0], a.c[1][0], a.c[2][0], a.c[1][1], a.c[2][1], a.c[2][2]};
}

// Operations of articulated inertias that other scalars do coordinate by coordinate.

template <>
inline ArticulatedInertia<Vectored> ArticulatedInertia<Vectored>::rigid(const Vectored& mass, const Vec3<Vectored>& h,
                                                                        const Sym3<Vectored>& at_origin) {
  const Mat3<Vectored> one = Mat3<Vectored>::identity();
  const Vec4d m = inAll(mass), zero{};
  return {{m * one.c[0], m * one.c[1], m * one.c[2]},
          {__builtin_shufflevector(h.a, zero, 4, 2, 1, 4) * Vec4d{0, -1, 1, 0}, __builtin_shufflevector(h.a, zero, 2, 4, 0, 4) * Vec4d{1, 0, -1, 0},
           __builtin_shufflevector(h.a, zero, 1, 0, 4, 4) * Vec4d{-1, 1, 0, 0}},
          at_origin};
}
/// The products come first, because the factor, a pivot's inverse, is known last.
template <>
inline void ArticulatedInertia<Vectored>::subtractSquare(const Force<Vectored>& W, const Vectored& factor) {
  const Vec4d &a = W.linear.a, &b = W.angular.a, all = inAll(factor);
  const auto column = [&]<int i>() {
    const Vec4d c = inAll<i>(a), d = inAll<i>(b);
    linear.c[i] -= a * c * all;
    coupling.c[i] -= a * d * all;
    angular.c[i] -= b * d * all;
  };
  column.template operator()<0>();
  column.template operator()<1>();
  column.template operator()<2>();
}
/// With X = [r]x: coupling' = coupling - linear X, angular' = angular + X coupling' + (X coupling)^T, where (X C)^T = - C^T X.
template <>
inline ArticulatedInertia<Vectored> ArticulatedInertia<Vectored>::shifted(const Vec3<Vectored>& r) const {
  const Vec4d x = inAll<0>(r.a), y = inAll<1>(r.a), z = inAll<2>(r.a);
  const auto minusTimesX = [&](const Vec4d* L, const Vec4d* to) {
    return Mat3<Vectored>{to[0] - L[1] * z + L[2] * y, to[1] + L[0] * z - L[2] * x, to[2] - L[0] * y + L[1] * x};
  };
  ArticulatedInertia out;
  out.linear = linear;
  out.coupling = minusTimesX(linear.c, coupling.c);
  const Mat3<Vectored> below = transpose(coupling), sum = minusTimesX(below.c, angular.c), turned = crossColumns(r, out.coupling);
  for (int i = 0; i < 3; ++i) out.angular.c[i] = sum.c[i] + turned.c[i];
  return out;
}

template <>
inline Mat3<Vectored> cast<Vectored, double>(const Mat3<double>& a) {
  return {Vec4d{a.m[0], a.m[3], a.m[6], 0}, Vec4d{a.m[1], a.m[4], a.m[7], 0}, Vec4d{a.m[2], a.m[5], a.m[8], 0}};
}

inline double numberOf(const Vectored& x) { return x.x; }
template <class S>
const S& numberOf(const S& x) {
  return x;
}
/// Converts each coordinate to a number of type To.
template <class To>
Vec3<To> cast(const Vec3<Vectored>& v) {
  return {To(v.a[0]), To(v.a[1]), To(v.a[2])};
}

inline Mat3<Vectored> symmetricMatrix(const Sym3<Vectored>& a) {
  const Vec4d &x = a.c[0], &y = a.c[1], &z = a.c[2];
  const Vec4d above_z = __builtin_shufflevector(x, y, 2, 6, 0, 0);
  return {x, __builtin_shufflevector(x, y, 1, 5, 6, 7), __builtin_shufflevector(above_z, z, 0, 1, 6, 7)};
}

// Overloads of those functions of the recursions that name single coordinates. The argument types select them.

inline Mat3<Vectored> loadMatrix(const Vectored* p, std::ptrdiff_t stride) {
  const auto column = [&](int i) { return Vec3<Vectored>(p[i * stride], p[(3 + i) * stride], p[(6 + i) * stride]).a; };
  return {column(0), column(1), column(2)};
}
inline Mat3<Vectored> turnZ(const Mat3<Vectored>& E, const Vectored& c, const Vectored& s) {
  return {E.c[0] * inAll(c) + E.c[1] * inAll(s), E.c[1] * inAll(c) - E.c[0] * inAll(s), E.c[2]};
}
/// R times a placement's rotation. If that only exchanges axes, the columns of R are permuted, which gives the same numbers faster. Each shift is a
/// case of its own, because the columns are in registers.
inline Mat3<Vectored> placedAxes(const Mat3<Vectored>& R, const Mat3<double>& placement, const AxisExchange& exchange) {
  if (exchange.shift < 0) return R * placement;
  const Vec4d sign = inAll(exchange.flips ? -1.0 : 1.0);
  if (exchange.shift == 0) return {R.c[0], sign * R.c[1], sign * R.c[2]};
  if (exchange.shift == 1) return {R.c[1], sign * R.c[2], sign * R.c[0]};
  return {R.c[2], sign * R.c[0], sign * R.c[1]};
}
/// Orthonormalises R by Newton's other step, the mean of R and R^-T (Higham 1986). The columns of R^-T are cross products divided by det R.
inline Mat3<Vectored> orthonormalised(const Mat3<Vectored>& R) {
  const Vec3<Vectored> x = R.c[0], y = R.c[1], z = R.c[2], yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  // Near 1, 1 / det is 2 - det, and det - 1 is half of |R|^2 - 3, which does not wait for the cross products. The sum is formed row by row, so that
  // its terms are small.
  const Vec4d half = inAll(0.5), excess = x.a * x.a - inAll(1) + y.a * y.a + z.a * z.a, weight = half - inAll(0.25) * totalInAll(excess);
  return {half * x.a + weight * yz.a, half * y.a + weight * zx.a, half * z.a + weight * xy.a};
}
inline Sym3<Vectored> shiftedInertia(const Sym3<Vectored>& I, const Vectored& mass, const Vec3<Vectored>& h, const Vec3<Vectored>& r) {
  const Vec4d k = h.a + inAll(Vectored(0.5) * mass) * r.a, product = dotInAll(k, r.a), diagonal = product + product;
  const Mat3<Vectored> one = Mat3<Vectored>::identity();
  const auto column = [&]<int i>() { return I.c[i] + (diagonal * one.c[i] - (k * inAll<i>(r.a) + r.a * inAll<i>(k))); };
  return {column.template operator()<0>(), column.template operator()<1>(), column.template operator()<2>()};
}

}  // namespace dyn
