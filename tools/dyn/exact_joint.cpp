// SPDX-License-Identifier: BSD-2-Clause
#include "exact_joint.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <map>

namespace dyn::tool {

namespace {

using T = TimeSeries;

Vec unit(int axis) { return Vec(Real(axis == 0 ? 1 : 0), Real(axis == 1 ? 1 : 0), Real(axis == 2 ? 1 : 0)); }

const std::vector<double>* numbers(const JointDescription& joint, const std::string& key) {
  const auto found = joint.parameters.find(key);
  return found == joint.parameters.end() ? nullptr : std::get_if<std::vector<double>>(&found->second);
}
double number(const JointDescription& joint, const std::string& key, double otherwise = 0) {
  const std::vector<double>* x = numbers(joint, key);
  return x && !x->empty() ? x->front() : otherwise;
}
/// A direction, normalised.
Vec direction(const JointDescription& joint, const std::string& key, const Vec& otherwise = unit(2)) {
  const std::vector<double>* x = numbers(joint, key);
  if (!x || x->size() != 3) return otherwise;
  const Vec axis((*x)[0], (*x)[1], (*x)[2]);
  return axis / axis.norm();
}

/// The rotation about an axis with this cosine and sine: I + s K + (1 - c) K^2.
Series turned(const Vec& axis, const T& c, const T& s) {
  const Mat K = cross(axis), K2 = K * K;
  Series out = Series::identity();
  for (std::size_t k = 0; k < 3; ++k) out.R[k] += s.c[k] * K - c.c[k] * K2;
  out.R[0] += K2;
  return out;
}
Series turned(const Vec& axis, const T& angle) {
  const Real c = cos(angle.c[0]), s = sin(angle.c[0]);
  return turned(axis, T::of(angle, c, -s, -c), T::of(angle, s, c, -s));
}
Series slid(const Vec& axis, const T& way) {
  Series out = Series::identity();
  for (std::size_t k = 0; k < 3; ++k) out.p[k] = way.c[k] * axis;
  return out;
}
Series slid(const T& x, const T& y, const T& z) { return slid(unit(0), x) * slid(unit(1), y) * slid(unit(2), z); }

/// The rotation of the quaternion (x, y, z, w) of any length: ((w^2 - u.u) I + 2 u u^T + 2 w cross(u)) / |q|^2.
Series turned(const T* q) {
  T n2, R[3][3];
  for (int i = 0; i < 4; ++i) n2 = n2 + q[i] * q[i];
  const T two = Real(2), &w = q[3], diagonal = w * w - (q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) R[i][j] = two * q[i] * q[j] + (i == j ? diagonal : T());
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    R[k][j] = R[k][j] + two * w * q[i];
    R[j][k] = R[j][k] - two * w * q[i];
  }
  const T by = inverse(n2);
  Series out = Series::identity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const T entry = R[i][j] * by;
      for (std::size_t k = 0; k < 3; ++k) out.R[k](i, j) = entry.c[k];
    }
  return out;
}
/// dq/dt = q (w, 0) / 2, a product of quaternions, for the angular velocity w in the moving frame.
void turn(const T* q, const T* w, T* dq) {
  const T half = Real(0.5);
  dq[3] = T();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    dq[i] = half * (q[3] * w[i] + q[j] * w[k] - q[k] * w[j]);
    dq[3] = dq[3] - half * q[i] * w[i];
  }
}
/// R v.
void rotate(const Series& R, const T* v, T* out) {
  for (int i = 0; i < 3; ++i) {
    out[i] = T();
    for (int j = 0; j < 3; ++j) out[i] = out[i] + T(R.R[0](i, j), R.R[1](i, j), R.R[2](i, j)) * v[j];
  }
}

/// Cosine and sine from a pair of any length but zero.
std::pair<T, T> onCircle(const T* q) {
  const T by = inverse(sqrt(q[0] * q[0] + q[1] * q[1]));
  return {q[0] * by, q[1] * by};
}

/// The smallest rotation that takes z to n: I + K + K^2 / (1 + n_z) with K = cross(z x n). There is none for n = -z.
Series pointed(const T* q) {
  const T by = inverse(sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2])), n[3] = {q[0] * by, q[1] * by, q[2] * by};
  const T k[3] = {T() - n[1], n[0], T()}, share = inverse(T(Real(1)) + n[2]);
  Series out = Series::identity();
  const T square = k[0] * k[0] + k[1] * k[1];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int l = 3 - i - j;
      T entry = share * (k[i] * k[j] - (i == j ? square : T()));
      if (i != j) entry = (j - i + 3) % 3 == 1 ? entry - k[l] : entry + k[l];
      for (std::size_t order = 0; order < 3; ++order) out.R[order](i, j) += entry.c[order];
    }
  return out;
}

/// The way on a rail of segments (length, curvature) in the xy plane. An arc is (sin, -cos) of the heading over the curvature.
Series onRail(const std::vector<double>& segments, const T& way) {
  Real start(0), heading(0), x(0), y(0), curvature(0);
  const auto piece = [&](const T& d, T& dx, T& dy) {
    const T to = T(heading) + T(curvature) * d;
    const bool straight = curvature == Real(0);
    dx = straight ? T(cos(heading)) * d : T(Real(1) / curvature) * (sin(to) - T(sin(heading)));
    dy = straight ? T(sin(heading)) * d : T(Real(1) / curvature) * (T(cos(heading)) - cos(to));
  };
  T dx, dy;
  for (std::size_t k = 0; way.c[0] > start && k < segments.size(); k += 2) {
    curvature = Real(segments[k + 1]);
    const Real length(segments[k]);
    if (way.c[0] < start + length) break;
    piece(T(length), dx, dy);
    x += dx.c[0];
    y += dy.c[0];
    heading += curvature * length;
    start += length;
    curvature = Real(0);
  }
  const T d = way - T(start);
  piece(d, dx, dy);
  return slid(T(x) + dx, T(y) + dy, T()) * turned(unit(2), T(heading) + T(curvature) * d);
}

/// The natural cubic spline through knots x y, x y, ...: the second derivative is zero at the ends; beyond them the spline is a line.
T spline(const std::vector<double>& xy, const T& x) {
  const auto n = static_cast<Eigen::Index>(xy.size() / 2);
  const auto at = [&](Eigen::Index k, int what) { return Real(xy[static_cast<std::size_t>(2 * k + what)]); };
  const auto h = [&](Eigen::Index k) { return at(k + 1, 0) - at(k, 0); };
  const auto slope = [&](Eigen::Index k) { return (at(k + 1, 1) - at(k, 1)) / h(k); };
  // The first derivative is continuous at the inner knots.
  MatrixR A = MatrixR::Identity(n);
  VectorR b = VectorR::Zero(n);
  for (Eigen::Index k = 1; k + 1 < n; ++k) {
    A(k, k - 1) = h(k - 1);
    A(k, k) = Real(2) * (h(k - 1) + h(k));
    A(k, k + 1) = h(k);
    b[k] = Real(6) * (slope(k) - slope(k - 1));
  }
  const VectorR m = A.inverse() * b;
  Eigen::Index k = 0;
  while (k + 2 < n && x.c[0] > at(k + 1, 0)) ++k;
  // y = y_k + d (slope - h (2 m_k + m_k+1) / 6) + d^2 m_k / 2 + d^3 (m_k+1 - m_k) / (6 h), d = x - x_k.
  const Real first = slope(k) - h(k) * (Real(2) * m[k] + m[k + 1]) / Real(6), third = (m[k + 1] - m[k]) / (Real(6) * h(k));
  const auto inside = [&](const T& d) { return T(at(k, 1)) + d * (T(first) + d * (T(m[k] / Real(2)) + d * T(third))); };
  if (x.c[0] < at(0, 0)) return T(at(0, 1)) + T(first) * (x - T(at(0, 0)));
  if (x.c[0] <= at(n - 1, 0)) return inside(x - T(at(k, 0)));
  const Real last = slope(k) + h(k) * (m[k] + Real(2) * m[k + 1]) / Real(6);
  return T(at(n - 1, 1)) + T(last) * (x - T(at(n - 1, 0)));
}

/// One of the six functions of a function_joint.
std::function<T(const T*)> functionOf(const JointDescription& joint, const std::string& name) {
  const std::vector<double>*p = numbers(joint, name + "_polynomial"), *s = numbers(joint, name + "_spline");
  const int coordinate = static_cast<int>(number(joint, name + "_coordinate"));
  if (s && s->size() >= 4) return [knots = *s, coordinate](const T* q) { return spline(knots, q[coordinate]); };
  return [c = p ? *p : std::vector<double>{}, coordinate](const T* q) { return polynomial(c, q[coordinate]); };
}

using Pose = std::function<Series(const T*)>;

/// A joint whose velocity is the derivative of its coordinates.
ExactJoint plain(int n, Pose pose) {
  return {n, n, std::move(pose), [n](const T*, const T* v, T* dq) { std::copy(v, v + n, dq); }};
}

ExactJoint functionJoint(const JointDescription& joint, int n) {
  std::vector<std::function<T(const T*)>> f;
  for (const char* name : {"r1", "r2", "r3", "tx", "ty", "tz"}) f.push_back(functionOf(joint, name));
  const Vec a = direction(joint, "axis1", unit(0)), b = direction(joint, "axis2", unit(1)), c = direction(joint, "axis3", unit(2));
  return plain(n, [=](const T* q) { return slid(f[3](q), f[4](q), f[5](q)) * turned(a, f[0](q)) * turned(b, f[1](q)) * turned(c, f[2](q)); });
}

ExactJoint composite(const JointDescription& joint) {
  const auto found = joint.parameters.find("parts");
  if (found == joint.parameters.end()) refuse(joint, "wants the parts of a composite joint");
  struct Part {
    ExactJoint joint;
    Series placement;
  };
  std::vector<Part> parts;
  ExactJoint out;
  for (const JointDescription& part : std::get<std::vector<JointDescription>>(found->second)) {
    if (!part.coupling.type.empty()) refuse(joint, "knows no parts that depend on other joints");
    parts.push_back({exactJoint(part), exactPlacement(part.placement)});
    out.nq += parts.back().joint.nq;
    out.nv += parts.back().joint.nv;
  }
  out.pose = [parts](const T* q) {
    Series pose = Series::identity();
    for (const Part& part : parts) {
      pose = pose * part.placement * part.joint.pose(q);
      q += part.joint.nq;
    }
    return pose;
  };
  out.rates = [parts](const T* q, const T* v, T* dq) {
    for (const Part& part : parts) {
      part.joint.rates(q, v, dq);
      q += part.joint.nq;
      dq += part.joint.nq;
      v += part.joint.nv;
    }
  };
  return out;
}

ExactJoint planar(const JointDescription& joint) {
  if (direction(joint, "axis") != unit(2)) refuse(joint, "knows planar joints about z alone");
  ExactJoint out;
  out.nq = 4;
  out.nv = 3;
  out.pose = [](const T* q) {
    const auto [c, s] = onCircle(q + 2);
    return slid(q[0], q[1], T()) * turned(unit(2), c, s);
  };
  out.rates = [](const T* q, const T* v, T* dq) {
    const auto [c, s] = onCircle(q + 2);
    dq[0] = c * v[0] - s * v[1];
    dq[1] = s * v[0] + c * v[1];
    dq[2] = T() - q[3] * v[2];
    dq[3] = q[2] * v[2];
  };
  return out;
}

using Maker = std::function<ExactJoint(const JointDescription&)>;

const std::map<std::string, Maker>& makers() {
  using J = const JointDescription&;
  static const std::map<std::string, Maker> all = [] {
    std::map<std::string, Maker> out{
        {"fixed", [](J) { return plain(0, [](const T*) { return Series::identity(); }); }},
        {"revolute", [](J j) { return plain(1, [a = direction(j, "axis")](const T* q) { return turned(a, q[0]); }); }},
        {"prismatic", [](J j) { return plain(1, [a = direction(j, "axis")](const T* q) { return slid(a, q[0]); }); }},
        {"continuous",
         [](J j) -> ExactJoint {
           return {2, 1,
                   [a = direction(j, "axis")](const T* q) {
                     const auto [c, s] = onCircle(q);
                     return turned(a, c, s);
                   },
                   [](const T* q, const T* v, T* dq) {
                     dq[0] = T() - q[1] * v[0];
                     dq[1] = q[0] * v[0];
                   }};
         }},
        {"helical",
         [](J j) {
           return plain(1, [a = direction(j, "axis"), p = T(Real(number(j, "pitch")))](const T* q) { return turned(a, q[0]) * slid(a, p * q[0]); });
         }},
        {"cylindrical", [](J j) { return plain(2, [a = direction(j, "axis")](const T* q) { return turned(a, q[0]) * slid(a, q[1]); }); }},
        {"universal",
         [](J j) {
           return plain(2, [a = direction(j, "axis"), b = direction(j, "axis2")](const T* q) { return turned(a, q[0]) * turned(b, q[1]); });
         }},
        {"spherical",
         [](J) -> ExactJoint {
           return {4, 3, [](const T* q) { return turned(q); }, turn};
         }},
        {"spherical_zyx",
         [](J) { return plain(3, [](const T* q) { return turned(unit(2), q[0]) * turned(unit(1), q[1]) * turned(unit(0), q[2]); }); }},
        {"translation", [](J) { return plain(3, [](const T* q) { return slid(q[0], q[1], q[2]); }); }},
        {"planar", planar},
        {"free_flyer",
         [](J) -> ExactJoint {
           return {7, 6, [](const T* q) { return slid(q[0], q[1], q[2]) * turned(q + 3); },
                   [](const T* q, const T* v, T* dq) {
                     rotate(turned(q + 3), v, dq);
                     turn(q + 3, v + 3, dq + 3);
                   }};
         }},
        {"ellipsoid",
         [](J j) {
           const std::vector<double> r = numbers(j, "radii") ? *numbers(j, "radii") : std::vector<double>(3);
           return plain(3, [r](const T* q) {
             const Series R = turned(unit(0), q[0]) * turned(unit(1), q[1]) * turned(unit(2), q[2]);
             // The origin is the turned z, scaled by the half axes.
             const auto scaled = [&](int i) {
               const Real by(r[static_cast<std::size_t>(i)]);
               return T(by * R.R[0](i, 2), by * R.R[1](i, 2), by * R.R[2](i, 2));
             };
             return slid(scaled(0), scaled(1), scaled(2)) * R;
           });
         }},
        {"composite", composite},
        {"ball_screw",
         [](J j) {
           return plain(1, [p = std::vector<double>{0, number(j, "p"), number(j, "c")}](const T* q) {
             return turned(unit(2), q[0]) * slid(unit(2), polynomial(p, q[0]));
           });
         }},
        {"cam_follower",
         [](J j) { return plain(1, [h = T(Real(number(j, "h")))](const T* q) { return slid(unit(2), h * (T(Real(1)) - cos(q[0]))); }); }},
        {"direction",
         [](J) -> ExactJoint {
           return {3, 2, pointed, [](const T* q, const T* v, T* dq) {
                     const T length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]), along[3] = {length * v[1], T() - length * v[0], T()};
                     rotate(pointed(q), along, dq);
                   }};
         }},
        {"planar_rail",
         [](J j) {
           const std::vector<double> s = numbers(j, "segments") ? *numbers(j, "segments") : std::vector<double>{};
           return plain(1, [s](const T* q) { return onRail(s, q[0]); });
         }},
    };
    for (int n = 1; n <= 6; ++n) out["function_joint" + (n == 1 ? std::string() : std::to_string(n))] = [n](J j) { return functionJoint(j, n); };
    return out;
  }();
  return all;
}

}  // namespace

std::vector<TimeSeries> ExactJoint::move(const Real* q, const Real* v, const Real* a) const {
  std::vector<T> x(static_cast<std::size_t>(nq)), velocity(static_cast<std::size_t>(nv)), dx = x;
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = T(q[k]);
  for (std::size_t k = 0; k < velocity.size(); ++k) velocity[k] = T(v[k], a[k]);
  // The first derivatives of the coordinates at time zero give their rates to first order, and so the second derivatives.
  for (const std::size_t order : {1U, 2U}) {
    rates(x.data(), velocity.data(), dx.data());
    for (std::size_t k = 0; k < x.size(); ++k) x[k].c[order] = dx[k].c[order - 1];
  }
  return x;
}

void refuse(const JointDescription& joint, const std::string& why) {
  throw Error(ErrorCode::joint_type, "the fifty-digit reference " + why, {joint.where.file, joint.where.line, joint.name});
}

ExactJoint exactJoint(const JointDescription& joint) {
  const auto found = makers().find(joint.type);
  if (found == makers().end()) refuse(joint, "has no definition of the joint type '" + joint.type + "'");
  return found->second(joint);
}

Series exactPlacement(const SE3<double>& placement) {
  Mat R(3, 3);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) R(r, c) = Real(placement.R(r, c));
  // Each iteration squares what is missing to a rotation (the polar factor by Newton and Schulz).
  for (int k = 0; k < 3; ++k) R = R * (Real(3) * Mat::Identity(3) - R.transpose() * R) / Real(2);
  return Series::constant(R, vec(placement.p));
}

TimeSeries polynomial(const std::vector<double>& coefficients, const TimeSeries& x) {
  T sum;
  for (std::size_t k = coefficients.size(); k-- > 0;) sum = sum * x + T(Real(coefficients[k]));
  return sum;
}

}  // namespace dyn::tool
