// SPDX-License-Identifier: BSD-2-Clause
// Joint types by their definitions, with fifty digits: a pose as a function of coordinates, and how coordinates move with the joint's velocity.
//
// The definitions are formulas of time: they take coordinates as power series and give poses as power series. They share no code with the plugins.
#pragma once

#include "exact.hpp"

#include <dyn/model/joint_description.hpp>

#include <functional>

namespace dyn::tool {

/// A number as a power series of time: its value and its first and second derivatives.
struct TimeSeries {
  std::array<Real, 3> c;

  TimeSeries(const Real& x = Real(0), const Real& first = Real(0), const Real& second = Real(0)) : c{x, first, second} {}  // NOLINT: meant to convert
  /// f(x) for a function with this value and these derivatives at x.
  static TimeSeries of(const TimeSeries& x, const Real& f, const Real& df, const Real& ddf) {
    return {f, df * x.c[1], ddf * x.c[1] * x.c[1] + df * x.c[2]};
  }
  friend TimeSeries operator+(const TimeSeries& a, const TimeSeries& b) { return {a.c[0] + b.c[0], a.c[1] + b.c[1], a.c[2] + b.c[2]}; }
  friend TimeSeries operator-(const TimeSeries& a, const TimeSeries& b) { return {a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}; }
  friend TimeSeries operator*(const TimeSeries& a, const TimeSeries& b) {
    return {a.c[0] * b.c[0], a.c[1] * b.c[0] + a.c[0] * b.c[1], a.c[2] * b.c[0] + Real(2) * a.c[1] * b.c[1] + a.c[0] * b.c[2]};
  }
  friend TimeSeries inverse(const TimeSeries& x) {
    const Real i = Real(1) / x.c[0];
    return of(x, i, -i * i, Real(2) * i * i * i);
  }
  friend TimeSeries sqrt(const TimeSeries& x) {
    const Real r = sqrt(x.c[0]), i = Real(1) / (Real(2) * r);
    return of(x, r, i, -i / (Real(2) * x.c[0]));
  }
  friend TimeSeries sin(const TimeSeries& x) {
    const Real s = sin(x.c[0]);
    return of(x, s, cos(x.c[0]), -s);
  }
  friend TimeSeries cos(const TimeSeries& x) {
    const Real s = cos(x.c[0]);
    return of(x, s, -sin(x.c[0]), -s);
  }
};

/// One joint. The arguments of the functions have nq coordinates or nv velocities; `rates` writes the time derivatives of the nq coordinates.
struct ExactJoint {
  int nq = 0, nv = 0;
  std::function<Series(const TimeSeries* q)> pose;
  std::function<void(const TimeSeries* q, const TimeSeries* v, TimeSeries* dq)> rates;

  /// The coordinates as series of time, for the velocities v at time zero with the time derivatives a.
  std::vector<TimeSeries> move(const Real* q, const Real* v, const Real* a) const;
};

/// Throws Error(joint_type), which names the joint.
[[noreturn]] void refuse(const JointDescription& joint, const std::string& why);

/// Throws Error(joint_type) for a type without definition, and for a planar joint whose axis is not z, because its x direction is arbitrary.
ExactJoint exactJoint(const JointDescription& joint);

/// The rigid motion that is nearest to a placement, whose rotation is rounded to doubles.
Series exactPlacement(const SE3<double>& placement);

/// c0 + c1 x + c2 x^2 + ...
TimeSeries polynomial(const std::vector<double>& coefficients, const TimeSeries& x);

}  // namespace dyn::tool
