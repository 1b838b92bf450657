// SPDX-License-Identifier: BSD-2-Clause
// A carriage on a planar rail of lines and arcs. q is the arc length along the rail [m]; the carriage's x axis points along it.
//
// A segment starts at point p0 with heading h0 and has curvature k. After an arc length d the heading is h0 + k d, and the chord has the length
// d sinc(k d / 2) and the direction h0 + k d / 2. Before the first and after the last segment the rail goes on straight.
#include <dyn_sdk/joint_plugin.hpp>

struct PlanarRail : dyn::sdk::Joint<PlanarRail, 1> {
  static constexpr const char* name = "planar_rail";
  static constexpr const char* summary = "carriage on a rail of lines and arcs in the xy plane, q the way along it [m]";
  static constexpr std::array parameters{dyn::ParameterSpec{"segments", dyn::ParameterKind::numbers, true, "m, 1/m",
                                                            "length and curvature of each: curvature 0 is a line, > 0 turns to the left",
                                                            "0.5 0  0.7854 2  0.4 0  0.9 -1.5"}};

  // Constants of each segment, and of the straight rest behind the last one: its start (arc length, x, y, heading) and its curvature.
  static constexpr int row = 5;
  static int constantCount(const dyn::ParameterArgument* a) { return row * (a[0].count / 2 + 1); }
  static bool check(const dyn::ParameterArgument* a, dyn::JointInstance&, const dyn::sdk::Refusal& refuse) {
    if (a[0].count < 2 || a[0].count % 2 != 0) return refuse("segments must be pairs of a length and a curvature, at least one");
    for (int k = 0; k < a[0].count; k += 2)
      if (!(a[0].numbers[k] > 0)) return refuse("each segment's length must be greater than 0");
    return true;
  }
  static void constants(const dyn::ParameterArgument* a, double* out) {
    // Ends are computed in extended precision, so that errors do not add up along the rail.
    long double way = 0, x = 0, y = 0, heading = 0;
    const int segments = a[0].count / 2;
    for (int k = 0; k <= segments; ++k) {
      const long double length = k < segments ? a[0].numbers[2 * k] : 0, curvature = k < segments ? a[0].numbers[2 * k + 1] : 0;
      for (const long double value : {way, x, y, heading, curvature}) *out++ = static_cast<double>(value);
      const long double half = curvature * length / 2, chord = length * sinc(half);
      x += chord * std::cos(heading + half);
      y += chord * std::sin(heading + half);
      heading += curvature * length;
      way += length;
    }
  }

  /// sin(u) / u. Small u use a series, since the quotient of dual numbers has no derivative at 0.
  template <class S>
  static S sinc(const S& u) {
    using std::sin;
    if (std::fabs(dyn::valueOf(u)) > 0.5) return sin(u) / u;
    const S t = u * u;
    S sum(1);
    for (int n = 16; n >= 2; n -= 2) sum = S(1) - t * sum / S(n * (n + 1));
    return sum;
  }
  static int segmentAt(double way, const dyn::sdk::Constants& c) {
    int k = 0;
    while (row * (k + 1) < c.size() && way >= c[row * (k + 1)]) ++k;
    return k;
  }
  static double curvatureAt(double way, const dyn::sdk::Constants& c) { return way < 0 ? 0 : c[row * segmentAt(way, c) + 4]; }

  template <class S>
  static dyn::SE3<S> pose(const S* q, const dyn::sdk::Constants& c) {
    using std::cos, std::sin;
    const int k = row * segmentAt(dyn::valueOf(q[0]), c);
    const S d = q[0] - S(c[k]);
    const S half = S(0.5 * curvatureAt(dyn::valueOf(q[0]), c)) * d, chord = d * sinc(half);
    const S along = S(c[k + 3]) + half, heading = along + half;
    const S cs = cos(heading), sn = sin(heading);
    return {{{cs, -sn, S(0), sn, cs, S(0), S(0), S(0), S(1)}}, {S(c[k + 1]) + chord * cos(along), S(c[k + 2]) + chord * sin(along), S(0)}};
  }
  /// Closed forms, which `dyn plugin check` compares with the pose: for each metre of arc length the carriage moves one metre along x and turns by
  /// the curvature, which is constant on each segment.
  template <class S>
  static void subspace(const S* q, const dyn::sdk::Constants& c, dyn::Motion<S>* columns) {
    columns[0] = {{S(1), S(0), S(0)}, {S(0), S(0), S(curvatureAt(dyn::valueOf(q[0]), c))}};
  }
  template <class S>
  static dyn::Motion<S> bias(const S*, const S*, const dyn::sdk::Constants&) {
    return {};
  }
};

DYN_EXPORT_JOINTS(PlanarRail)
