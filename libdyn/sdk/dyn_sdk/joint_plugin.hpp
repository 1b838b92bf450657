// SPDX-License-Identifier: BSD-2-Clause
// The only header that a plugin author includes.
//
// A joint type is a class with a name, a summary, parameters and a pose map, which is a template over the scalar:
//
//     struct CamFollower : dyn::sdk::Joint<CamFollower, 1> {
//       static constexpr const char* name = "cam_follower";
//       static constexpr const char* summary = "moves along z by h (1 - cos q)";
//       static constexpr std::array parameters{dyn::ParameterSpec{"h", dyn::ParameterKind::number, true, "m", "half the stroke"}};
//       template <class S> static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) { ... c[0] * (1 - cos(q[0])) ... }
//     };
//     DYN_EXPORT_JOINTS(CamFollower)
//
// Optional members are found by name; the SDK derives missing ones:
//     branch_free = true          pose map, subspace, bias and rates have no branches on q: they are then computed for packs of joints or states
//     shape, check(args, instance, refuse), constantCount(args), constants(args, out)
//     coordinates(q, c, pose)     the core's pose components in the order of its Shape, for shapes other than dense
//     subspace(q, c, S)           S for dense shapes, column after column
//     bias(q, v, c)               (dS/dt) v
//
// By default q is a vector and v = dq/dt. A joint with another configuration space, for example unit vectors, also writes these members, each with
// or without the argument c:
//     neutral(c, q)               q where the joint is "at zero"
//     normalize(c, q)             brings q back onto the configuration space; returns its distance from that space before
//     integrate(q, v, c, out)     q (+) v: where the joint is after one second of v; a template over the scalar
//     difference(q0, q1, c, v)    the v with q0 (+) v = q1
// It may also write these closed forms:
//     rates(q, v, c, dq)          dq/dt, a template over the scalar; dense shapes that are branch_free need it
//     dIntegrate(q, v, c, Jq, Jv), dDifference(q0, q1, c, J0, J1)     nv x nv, row-major
#pragma once

#include <dyn_sdk/constants.hpp>
#include <dyn_sdk/stamp.hpp>

#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <vector>

namespace dyn::sdk {

/// Returns how many numbers a parameter of this kind has; 0 for a list of numbers, whose length depends on the model, and for parameters without
/// numbers.
constexpr int numberCount(ParameterKind kind) { return kind == ParameterKind::number ? 1 : kind == ParameterKind::vector3 ? 3 : 0; }

/// Returns whether each number of the schema has a fixed place among the constants, whatever a model leaves out. For this, a list of numbers must be
/// the last parameter that has numbers.
template <class Specs>
constexpr bool hasPlaces(const Specs& parameters) {
  bool list = false;
  for (const ParameterSpec& spec : parameters) {
    if (list && (spec.kind == ParameterKind::numbers || numberCount(spec.kind) > 0)) return false;
    list = list || spec.kind == ParameterKind::numbers;
  }
  return true;
}

/// Writes the numbers of all parameters in the order of the schema, each at its place. An optional parameter that is not given has zeros. Returns how
/// many numbers there are; without `out` it only counts.
template <class Specs>
int placeNumbers(const Specs& parameters, const ParameterArgument* a, double* out) {
  int n = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const int size = a[i].count > 0 ? a[i].count : numberCount(parameters[i].kind);
    for (int k = 0; out && k < size; ++k) out[n + k] = k < a[i].count ? a[i].numbers[k] : 0;
    n += size;
  }
  return n;
}

/// Refuses parameters: `return refuse("the radius must be positive");`.
struct Refusal {
  char* text;  ///< where the reason goes
  int size;    ///< its bytes; longer reasons are cut
  /// Writes the reason and returns false.
  bool operator()(const char* reason) const {
    std::snprintf(text, static_cast<std::size_t>(size), "%s", reason);
    return false;
  }
};

/// Writes the unit vector along xyz, without underflow or overflow. Returns false if xyz is zero or not finite. The result has extended precision, so
/// that numbers computed from it can be rounded once.
inline bool unitVector(const double* xyz, Vec3<long double>& out) {
  const double m = std::fmax(std::fabs(xyz[0]), std::fmax(std::fabs(xyz[1]), std::fabs(xyz[2])));
  if (!(m > 0) || !std::isfinite(m)) return false;
  const Vec3<long double> a{static_cast<long double>(xyz[0]) / m, static_cast<long double>(xyz[1]) / m, static_cast<long double>(xyz[2]) / m};
  const long double n = std::sqrt(dot(a, a));
  out = {a.x / n, a.y / n, a.z / n};
  return true;
}

/// Returns a rotation whose third column is the unit vector n. It is a cyclic permutation if n is a positive axis of the frame.
inline Mat3<double> frameWithZ(const Vec3<long double>& n) {
  const long double ax = std::fabs(n.x), ay = std::fabs(n.y), az = std::fabs(n.z);
  Vec3<long double> x = az >= ax && az >= ay ? Vec3<long double>{1, 0, 0} : (ax >= ay ? Vec3<long double>{0, 1, 0} : Vec3<long double>{0, 0, 1});
  x -= dot(x, n) * n;
  const long double l = std::sqrt(dot(x, x));
  x = {x.x / l, x.y / l, x.z / l};
  const Vec3<long double> y = cross(n, x);
  const auto d = [](long double v) { return static_cast<double>(v); };
  return {{d(x.x), d(y.x), d(n.x), d(x.y), d(y.y), d(n.y), d(x.z), d(y.z), d(n.z)}};
}

/// Returns the result of `judge`, an author's function that may throw. An exception becomes a refusal with the exception's text.
template <class Judge>
bool guarded(const Refusal& refuse, const Judge& judge) noexcept {
  try {
    return judge();
  } catch (const std::exception& e) {
    return refuse(e.what());
  } catch (...) {
    return refuse("it threw something that is no std::exception");
  }
}

/// Lets an author's `write` fill `count` constants once into a larger trial array. Refuses if it writes more than `count`. Exceptions pass.
template <class Write>
bool tryConstants(int count, int numbers, const Refusal& refuse, const Write& write) {
  if (count < 0) return refuse("its number of constants is negative");
  constexpr double untouched = -0x1.5a5a5a5a5a5a5p-700;
  std::vector<double> trial(static_cast<std::size_t>(count) + static_cast<std::size_t>(numbers) + 64, untouched);
  write(trial.data());
  for (std::size_t k = static_cast<std::size_t>(count); k < trial.size(); ++k)
    if (trial[k] != untouched) return refuse("constants writes more numbers than constantCount says");
  return true;
}

/// Base class of a joint type. Author is the type's class itself, NV its degrees of freedom (at most max_joint_nv), NQ its coordinates (at most
/// max_joint_nq). The members here are the defaults; Author may hide each by a member of its own.
template <class Author, int NV, int NQ = NV>
struct Joint {
  static constexpr int nv = NV,                             ///< degrees of freedom
      nq = NQ;                                              ///< coordinates
  static constexpr Shape shape = Shape::dense;              ///< motion subspace
  static constexpr Structure structure = Structure::joint;  ///< one joint
  static constexpr bool branch_free = false;                ///< whether pose map, subspace, bias and rates have no branches on q
  /// Return the number of constants c[k], and write them. By default the constants are the numbers of all parameters in the order of the schema; an
  /// optional parameter that is not given has zeros.
  /// @{
  static int constantCount(const ParameterArgument* a) { return placeNumbers(Author::parameters, a, nullptr); }
  static void constants(const ParameterArgument* a, double* out) {
    static_assert(
        hasPlaces(Author::parameters),
        "a list of numbers before other numbers moves them: make it the last parameter that has numbers, or write constantCount and constants");
    placeNumbers(Author::parameters, a, out);
  }
  /// @}
  /// Accepts all parameters that fit the schema.
  static bool check(const ParameterArgument*, JointInstance&, const Refusal&) { return true; }
  static constexpr std::array<ParameterSpec, 0> parameters{};  ///< schema without parameters
};

}  // namespace dyn::sdk

#include <dyn_sdk/coupling.hpp>
