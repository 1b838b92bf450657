// SPDX-License-Identifier: BSD-2-Clause
// A joint's configuration space: the functions that its author wrote, and defaults or derived functions for the others.
//
// A joint without functions of its own has q in R^n and v = dq/dt. A joint with its own q (+) v provides neutral, integrate, difference and
// normalize; rates and the Jacobians are derived from these. Each function may take the joint's constants.
#pragma once

#include <dyn_sdk/constants.hpp>
#include <dyn_sdk/derive.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::sdk {

/// Writes the X that minimises |A X - B|, for A of full column rank, by modified Gram-Schmidt on A's columns and then on B's (Bjorck 1967). Matrices
/// are row-major: A rows x columns, B rows x wanted, X columns x wanted. A and B are overwritten.
template <int rows, int columns, int wanted>
void leastSquares(double* A, double* B, double* X) {
  double R[columns * columns], Y[columns * wanted];
  const auto dot = [](const double* a, int stride_a, const double* b, int stride_b) {
    double sum = 0;
    for (int r = 0; r < rows; ++r) sum += a[r * stride_a] * b[r * stride_b];
    return sum;
  };
  for (int k = 0; k < columns; ++k) {
    const double length = std::sqrt(dot(A + k, columns, A + k, columns));
    R[k * columns + k] = length;
    for (int r = 0; r < rows; ++r) A[r * columns + k] /= length;
    for (int j = k + 1; j < columns; ++j) {
      const double share = R[k * columns + j] = dot(A + k, columns, A + j, columns);
      for (int r = 0; r < rows; ++r) A[r * columns + j] -= share * A[r * columns + k];
    }
    for (int j = 0; j < wanted; ++j) {
      const double share = Y[k * wanted + j] = dot(A + k, columns, B + j, wanted);
      for (int r = 0; r < rows; ++r) B[r * wanted + j] -= share * A[r * columns + k];
    }
  }
  for (int j = 0; j < wanted; ++j)
    for (int k = columns - 1; k >= 0; --k) {
      double x = Y[k * wanted + j];
      for (int i = k + 1; i < columns; ++i) x -= R[k * columns + i] * X[i * wanted + j];
      X[k * wanted + j] = x / R[k * columns + k];
    }
}

/// The author wrote q (+) v for scalars S.
template <class A, class S>
concept HasIntegrate =
    requires(const S* q, const Constants& c, S* out) { A::integrate(q, q, c, out); } || requires(const S* q, S* out) { A::integrate(q, q, out); };
/// The author wrote dq/dt.
template <class A>
concept HasRates = requires(const double* q, const Constants& c, double* out) { A::rates(q, q, c, out); };

/// The configuration space of the author's class A: its own functions, and defaults or derived functions for the others. C is a type of constants.
template <class A>
struct Configuration {
  static constexpr int nq = A::nq,                      ///< coordinates
      nv = A::nv;                                       ///< degrees of freedom
  static constexpr bool own = HasIntegrate<A, double>;  ///< the author wrote q (+) v
  /// The author wrote q (+) v as a template over the scalar, so that it can be differentiated.
  static constexpr bool differentiable = own && HasIntegrate<A, Dual<double>>;
  /// v may differ from dq/dt.
  static constexpr bool curved = HasRates<A> || differentiable || nq != nv;

  static_assert(own || nq == nv, "a joint with more coordinates than velocities needs its own neutral, integrate, difference and normalize");

  /// Writes the q where the joint is "at zero".
  template <class C>
  static void neutral(const C& c, double* q) {
    if constexpr (requires { A::neutral(c, q); }) {
      A::neutral(c, q);
    } else if constexpr (requires { A::neutral(q); }) {
      A::neutral(q);
    } else {
      static_assert(nq == nv, "neutral(q) is missing");
      std::fill_n(q, nq, 0.0);
    }
  }

  /// Writes out = q (+) v.
  template <class S, class C>
  static void integrate(const S* q, const S* v, const C& c, S* out) {
    if constexpr (requires { A::integrate(q, v, c, out); }) {
      A::integrate(q, v, c, out);
    } else if constexpr (requires { A::integrate(q, v, out); }) {
      A::integrate(q, v, out);
    } else {
      for (int k = 0; k < nv; ++k) out[k] = q[k] + v[k];
    }
  }

  /// Writes v = q1 (-) q0.
  template <class C>
  static void difference(const double* q0, const double* q1, const C& c, double* v) {
    if constexpr (requires { A::difference(q0, q1, c, v); }) {
      A::difference(q0, q1, c, v);
    } else if constexpr (requires { A::difference(q0, q1, v); }) {
      A::difference(q0, q1, v);
    } else {
      static_assert(nq == nv, "difference(q0, q1, v) is missing");
      for (int k = 0; k < nv; ++k) v[k] = q1[k] - q0[k];
    }
  }

  /// Brings q back onto the configuration space. Returns its distance from that space before.
  template <class C>
  static double normalize(const C& c, double* q) {
    if constexpr (requires { A::normalize(c, q); }) {
      return A::normalize(c, q);
    } else if constexpr (requires { A::normalize(q); }) {
      return A::normalize(q);
    } else {
      static_assert(nq == nv, "normalize(q) is missing");
      return 0;
    }
  }

  /// Writes dq/dt for velocities v into dq.
  template <class S, class C>
  static void rates(const S* q, const S* v, const C& c, S* dq) {
    if constexpr (HasRates<A>) {
      A::rates(q, v, c, dq);
    } else if constexpr (differentiable) {
      std::fill_n(dq, nq, S(0));
      for (int k = 0; k < nv; ++k) {
        S column[nq];
        rateColumn(q, k, c, column);
        for (int r = 0; r < nq; ++r) dq[r] += v[k] * column[r];
      }
    } else {
      static_assert(nq == nv, "dq/dt is not known: make integrate a template over the scalar, or write rates(q, v, c, dq)");
      std::copy_n(v, nv, dq);
    }
  }

  /// Writes the derivatives of q (+) v by q and by v, nv x nv, row-major, both in tangent spaces.
  template <class C>
  static void dIntegrate(const double* q, const double* v, const C& c, double* Jq, double* Jv) {
    if constexpr (requires { A::dIntegrate(q, v, c, Jq, Jv); }) {
      A::dIntegrate(q, v, c, Jq, Jv);
    } else if constexpr (requires { A::dIntegrate(q, v, Jq, Jv); }) {
      A::dIntegrate(q, v, Jq, Jv);
    } else if constexpr (!own || !curved) {
      diagonal(1, Jq);
      diagonal(1, Jv);
    } else {
      static_assert(differentiable, "dIntegrate is not known: make integrate a template over the scalar, or write dIntegrate(q, v, Jq, Jv)");
      differentiated(q, v, c, Jq, Jv);
    }
  }

  /// Writes the derivatives of q1 (-) q0 by q0 and by q1, nv x nv, row-major, both in tangent spaces.
  template <class C>
  static void dDifference(const double* q0, const double* q1, const C& c, double* J0, double* J1) {
    if constexpr (requires { A::dDifference(q0, q1, c, J0, J1); }) {
      A::dDifference(q0, q1, c, J0, J1);
    } else if constexpr (requires { A::dDifference(q0, q1, J0, J1); }) {
      A::dDifference(q0, q1, J0, J1);
    } else if constexpr (!own || !curved) {
      diagonal(-1, J0);
      diagonal(1, J1);
    } else {
      inverted(q0, q1, c, J0, J1);
    }
  }

 private:
  /// The v at which q (+) v is differentiated in place of v = 0: not zero, so that sin(|v|) / |v| has a derivative, but so large that its square
  /// still has all digits.
  template <class S>
  static constexpr Real<S> beside_zero = std::is_same_v<Real<S>, float> ? Real<S>(0x1p-30) : Real<S>(0x1p-250);

  template <class S, class C>
  static void rateColumn(const S* q, int k, const C& c, S* column) {
    using D = Dual<S>;
    D x[nq], v[nv], out[nq];
    for (int i = 0; i < nq; ++i) x[i] = D(q[i], S(0));
    for (int i = 0; i < nv; ++i) v[i] = i == k ? D(S(beside_zero<S>), S(1)) : D(S(0), S(0));
    integrate(x, v, c, out);
    for (int i = 0; i < nq; ++i) column[i] = out[i].d;
  }

  static void diagonal(double value, double* J) {
    for (int k = 0; k < nv * nv; ++k) J[k] = k % (nv + 1) == 0 ? value : 0.0;
  }

  /// Derivatives of q (+) v in forward mode: changes of its coordinates, converted to velocities by least squares.
  template <class C>
  static void differentiated(const double* q, const double* v, const C& c, double* Jq, double* Jv) {
    using D = Dual<double>;
    double end[nq], rates_at_end[nq * nv], changes[nq * 2 * nv], J[nv * 2 * nv];
    integrate(q, v, c, end);
    const bool still = std::all_of(v, v + nv, [](double x) { return x == 0; });
    for (int k = 0; k < nv; ++k) {
      const auto change = [&](bool by_q) {
        D x[nq], u[nv], out[nq];
        double unit[nv] = {}, dq[nq] = {};
        unit[k] = 1;
        if (by_q) rates(q, unit, c, dq);
        for (int i = 0; i < nq; ++i) x[i] = D(q[i], dq[i]);
        for (int i = 0; i < nv; ++i) u[i] = D(still ? beside_zero<double> * unit[i] : v[i], by_q ? 0.0 : unit[i]);
        integrate(x, u, c, out);
        for (int i = 0; i < nq; ++i) changes[2 * nv * i + (by_q ? 0 : nv) + k] = out[i].d;
      };
      change(true);
      change(false);
      double unit[nv] = {}, column[nq];
      unit[k] = 1;
      rates(end, unit, c, column);
      for (int i = 0; i < nq; ++i) rates_at_end[nv * i + k] = column[i];
    }
    leastSquares<nq, nv, 2 * nv>(rates_at_end, changes, J);
    for (int r = 0; r < nv; ++r) {
      std::copy_n(J + 2 * nv * r, nv, Jq + nv * r);
      std::copy_n(J + 2 * nv * r + nv, nv, Jv + nv * r);
    }
  }

  /// Derivatives of d = q1 (-) q0 from those of q1 = q0 (+) d: Jv dd = dq1 - Jq dq0.
  template <class C>
  static void inverted(const double* q0, const double* q1, const C& c, double* J0, double* J1) {
    double d[nv], Jq[nv * nv], Jv[nv * nv], right[nv * 2 * nv], J[nv * 2 * nv];
    difference(q0, q1, c, d);
    dIntegrate(q0, d, c, Jq, Jv);
    for (int r = 0; r < nv; ++r)
      for (int k = 0; k < nv; ++k) {
        right[2 * nv * r + k] = -Jq[nv * r + k];
        right[2 * nv * r + nv + k] = r == k ? 1 : 0;
      }
    leastSquares<nv, nv, 2 * nv>(Jv, right, J);
    for (int r = 0; r < nv; ++r) {
      std::copy_n(J + 2 * nv * r, nv, J0 + nv * r);
      std::copy_n(J + 2 * nv * r + nv, nv, J1 + nv * r);
    }
  }
};

/// Returns column k of the motion subspace, derived from the pose map.
template <class A, class S, class C>
Motion<S> derivedColumn(const S* q, const C& c, int k) {
  S unit[A::nv], dq[A::nq];
  for (int i = 0; i < A::nv; ++i) unit[i] = S(i == k ? 1 : 0);
  const S* rate = unit;
  if constexpr (Configuration<A>::curved) {
    Configuration<A>::rates(q, unit, c, dq);
    rate = dq;
  }
  return poseVelocity<A::nq>([&c](const auto* x) { return A::pose(x, c); }, q, rate);
}

/// Returns the pose, S v and (dS/dt) v, derived from the pose map.
template <class A, class S, class C>
PoseRates<S> derivedRates(const S* q, const S* v, const C& c) {
  const auto pose = [&c](const auto* x) { return A::pose(x, c); };
  if constexpr (Configuration<A>::curved) {
    using D = Dual<S>;
    S dq[A::nq], ddq[A::nq];
    Configuration<A>::rates(q, v, c, dq);
    D x[A::nq], u[A::nv], rate[A::nq];
    for (int i = 0; i < A::nq; ++i) x[i] = D(q[i], dq[i]);
    for (int i = 0; i < A::nv; ++i) u[i] = D(v[i], S(0));
    Configuration<A>::rates(x, u, c, rate);
    for (int i = 0; i < A::nq; ++i) ddq[i] = rate[i].d;
    return poseRates<A::nq>(pose, q, dq, ddq);
  } else {
    const S still[A::nq] = {};
    return poseRates<A::nq>(pose, q, v, still);
  }
}

}  // namespace dyn::sdk
