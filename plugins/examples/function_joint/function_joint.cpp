// SPDX-License-Identifier: BSD-2-Clause
// A joint whose six pose coordinates are functions of one to six coordinates q, as users of OpenSim describe knees and shoulders:
// rotations r1, r2, r3 about axis1, axis2, axis3 (each fixed to the frame that the rotations before it have turned), and translations tx, ty,
// tz in the joint frame. Each function is a polynomial or a natural cubic spline of one q; it is 0 if neither is given.
#include "function.hpp"

#include <dyn_sdk/joint_plugin.hpp>

namespace {

using dyn::ParameterKind;
using dyn::ParameterSpec;

constexpr int functions = 6, axes = 3;
constexpr std::array function_names{"r1", "r2", "r3", "tx", "ty", "tz"};

// The schema has three parameters for each function, then the axes.
constexpr int polynomialOf(int f) { return 3 * f; }
constexpr int splineOf(int f) { return 3 * f + 1; }
constexpr int coordinateOf(int f) { return 3 * f + 2; }
constexpr int axisOf(int k) { return 3 * functions + k; }

constexpr const char* polynomial_help = "coefficients, the constant first";
constexpr const char* spline_help = "knots x y, x y, ... with growing x; linear beyond the first and the last";
constexpr const char* coordinate_help = "number of the q that it is a function of, counted from 0; 0 when left out";
constexpr const char* axis_help = "direction of the rotation; x, y, z when left out";

constexpr const char* digits[]{"0", "1", "2", "3", "4", "5"};

/// In the examples, which tests use, the six functions take the N coordinates in turn.
template <int N>
constexpr std::array<ParameterSpec, 3 * functions + axes> schema{{
    {"r1_polynomial", ParameterKind::numbers, false, "rad", polynomial_help, "0 1"},
    {"r1_spline", ParameterKind::numbers, false, "rad", spline_help, ""},
    {"r1_coordinate", ParameterKind::number, false, "", coordinate_help, digits[0]},
    {"r2_polynomial", ParameterKind::numbers, false, "rad", polynomial_help, "0.1 0.8 -0.05"},
    {"r2_spline", ParameterKind::numbers, false, "rad", spline_help, ""},
    {"r2_coordinate", ParameterKind::number, false, "", coordinate_help, digits[1 % N]},
    {"r3_polynomial", ParameterKind::numbers, false, "rad", polynomial_help, ""},
    {"r3_spline", ParameterKind::numbers, false, "rad", spline_help, "-2 -0.8 -0.4 0.2 0.9 0.6 2 1.5"},
    {"r3_coordinate", ParameterKind::number, false, "", coordinate_help, digits[2 % N]},
    {"tx_polynomial", ParameterKind::numbers, false, "m", polynomial_help, ""},
    {"tx_spline", ParameterKind::numbers, false, "m", spline_help, "-2 -0.4 -0.4 0.1 0.9 0.4 2 0.9"},
    {"tx_coordinate", ParameterKind::number, false, "", coordinate_help, digits[3 % N]},
    {"ty_polynomial", ParameterKind::numbers, false, "m", polynomial_help, "-0.3 0.4 0.01"},
    {"ty_spline", ParameterKind::numbers, false, "m", spline_help, ""},
    {"ty_coordinate", ParameterKind::number, false, "", coordinate_help, digits[4 % N]},
    {"tz_polynomial", ParameterKind::numbers, false, "m", polynomial_help, "0 0.5"},
    {"tz_spline", ParameterKind::numbers, false, "m", spline_help, ""},
    {"tz_coordinate", ParameterKind::number, false, "", coordinate_help, digits[5 % N]},
    {"axis1", ParameterKind::vector3, false, "", axis_help, "0 0 1"},
    {"axis2", ParameterKind::vector3, false, "", axis_help, "0 1 0"},
    {"axis3", ParameterKind::vector3, false, "", axis_help, "1 0 0"},
}};

/// Rotation about the unit vector n.
template <class S>
dyn::Mat3<S> turn(const dyn::Vec3<S>& n, const S& angle) {
  using std::cos, std::sin;
  const S c = cos(angle), s = sin(angle);
  dyn::Mat3<S> R = s * dyn::skew(n);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) R(i, j) += (S(1) - c) * n[i] * n[j];
    R(i, i) += c;
  }
  return R;
}

constexpr std::array type_names{"function_joint", "function_joint2", "function_joint3", "function_joint4", "function_joint5", "function_joint6"};

template <int N>
struct FunctionJoint : dyn::sdk::Joint<FunctionJoint<N>, N> {
  static constexpr const char* name = type_names[N - 1];
  static constexpr const char* summary = "rotations and translations that are polynomials or splines of the coordinates q [rad or m]";
  static constexpr const auto& parameters = schema<N>;

  /// Constants: the axes, then the functions one after the other.
  static int constantCount(const dyn::ParameterArgument* a) {
    int n = 3 * axes;
    for (int f = 0; f < functions; ++f) n += function::size(a[polynomialOf(f)].count, a[splineOf(f)].count);
    return n;
  }
  static bool check(const dyn::ParameterArgument* a, dyn::JointInstance&, const dyn::sdk::Refusal& refuse) {
    char text[128];
    const auto wrong = [&](int f, const char* what) {
      std::snprintf(text, sizeof text, "%s: %s", function_names[static_cast<std::size_t>(f)], what);
      return refuse(text);
    };
    for (int f = 0; f < functions; ++f) {
      const dyn::ParameterArgument &polynomial = a[polynomialOf(f)], &spline = a[splineOf(f)], &coordinate = a[coordinateOf(f)];
      if (polynomial.given && spline.given) return wrong(f, "is a polynomial or a spline, not both");
      if (spline.given && !function::isKnots(spline.numbers, spline.count)) return wrong(f, "a spline needs two knots x y or more, with growing x");
      if (coordinate.given &&
          !(coordinate.numbers[0] >= 0 && coordinate.numbers[0] < N && coordinate.numbers[0] == std::floor(coordinate.numbers[0])))
        return wrong(f, "the joint has no coordinate of that number");
    }
    dyn::Vec3<long double> n;
    for (int k = 0; k < axes; ++k)
      if (a[axisOf(k)].given && !dyn::sdk::unitVector(a[axisOf(k)].numbers, n)) return refuse("an axis must be a vector other than zero");
    return true;
  }
  static void constants(const dyn::ParameterArgument* a, double* out) {
    for (int k = 0; k < axes; ++k) {
      dyn::Vec3<long double> n{k == 0 ? 1.0L : 0.0L, k == 1 ? 1.0L : 0.0L, k == 2 ? 1.0L : 0.0L};
      if (a[axisOf(k)].given) dyn::sdk::unitVector(a[axisOf(k)].numbers, n);
      for (int i = 0; i < 3; ++i) *out++ = static_cast<double>(n[i]);
    }
    for (int f = 0; f < functions; ++f) {
      const dyn::ParameterArgument &polynomial = a[polynomialOf(f)], &spline = a[splineOf(f)], &coordinate = a[coordinateOf(f)];
      out = function::write(coordinate.given ? coordinate.numbers[0] : 0.0, polynomial.numbers, polynomial.count, spline.numbers, spline.count, out);
    }
  }

  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    S x[functions];
    int at = 3 * axes;
    for (S& value : x) value = function::evaluate(q, c, at);
    const auto axis = [&](int k) { return dyn::Vec3<S>{S(c[3 * k]), S(c[3 * k + 1]), S(c[3 * k + 2])}; };
    return {turn(axis(0), x[0]) * turn(axis(1), x[1]) * turn(axis(2), x[2]), {x[3], x[4], x[5]}};
  }
};

}  // namespace

DYN_EXPORT_JOINTS(FunctionJoint<1>, FunctionJoint<2>, FunctionJoint<3>, FunctionJoint<4>, FunctionJoint<5>, FunctionJoint<6>)
