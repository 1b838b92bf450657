// SPDX-License-Identifier: BSD-2-Clause
// Functions of rotations and rigid motions against hundred-digit references: power series of matrices, their inverses, and the arc tangent.
#include "bench.hpp"
#include "errors.hpp"
#include "exact_matrix.hpp"
#include "interrupt.hpp"
#include "progress.hpp"
#include "sections.hpp"

#include <dyn/lie/se3.hpp>

#include <algorithm>
#include <functional>
#include <random>

namespace dyn::tool {

namespace {

using Real = ExactNumber<100>;
using Matrix = ExactMatrix<100>;

/// Angles are at most half a turn, so the last term of a series of this length is below 1e-90.
constexpr int terms = 110;

/// sum x^k / (k + m)!
Matrix series(const Matrix& x, int m) {
  Matrix sum = Matrix::Zero(x.rows(), x.rows()), term = Matrix::Identity(x.rows());
  for (int k = 1; k <= m; ++k) term /= Real(k);
  for (int k = 0; k < terms; ++k) {
    sum += term;
    term = term * x / Real(k + m + 1);
  }
  return sum;
}

Matrix cross(const Vec3<double>& w) { return Matrix::cross({w.x, w.y, w.z}); }
Matrix bracket(const Motion<double>& m) {
  Matrix out(6, 6);
  out.block(0, 0, 3, 3) = out.block(3, 3, 3, 3) = cross(m.angular);
  out.block(0, 3, 3, 3) = cross(m.linear);
  return out;
}
/// The upper right block of a 6 x 6 matrix.
std::vector<long double> upper(const Matrix& x) { return x.block(0, 3, 3, 3).rounded(); }

std::vector<double> numbers(const Mat3<double>& x) { return {x.m, x.m + 9}; }
std::vector<double> numbers(const Vec3<double>& x) { return {x.x, x.y, x.z}; }

struct Function {
  const char* name;
  std::function<std::vector<double>(const Motion<double>&)> value;
  std::function<std::vector<long double>(const Motion<double>&)> truth;
  std::function<double(const Motion<double>&)> call;  ///< for timing; returns one number of the result
};

std::vector<Function> functions() {
  using M = Motion<double>;
  const auto jexp6 = [](const M& m) { return series(-bracket(m), 1); };
  return {
      {"exp3", [](const M& m) { return numbers(exp3(m.angular)); }, [](const M& m) { return series(cross(m.angular), 0).rounded(); },
       [](const M& m) { return exp3(m.angular).m[1]; }},
      {"exp6, translation", [](const M& m) { return numbers(exp6(m).p); },
       [](const M& m) {
         Matrix x(4, 4);
         x.block(0, 0, 3, 3) = cross(m.angular);
         for (int i = 0; i < 3; ++i) x(i, 3) = Real(m.linear[i]);
         return series(x, 0).block(0, 3, 3, 1).rounded();
       },
       [](const M& m) { return exp6(m).p.x; }},
      {"log3", [](const M& m) { return numbers(log3(expQuaternion(m.angular))); },
       [](const M& m) {
         // The reference starts from the rounded quaternion.
         const Quaternion<double> q = expQuaternion(m.angular);
         const Matrix im(q.x, q.y, q.z);
         const Real size = im.norm(), angle = 2 * atan2(q.w < 0 ? Real(-size) : size, Real(std::abs(q.w)));
         return (angle / size * im).rounded();
       },
       [](const M& m) {
         return log3(Quaternion<double>{m.angular.x, m.angular.y, m.angular.z, 0.5}).x;
       }},
      {"Jexp3", [](const M& m) { return numbers(Jexp3(m.angular)); }, [](const M& m) { return series(-cross(m.angular), 1).rounded(); },
       [](const M& m) { return Jexp3(m.angular).m[1]; }},
      {"Jlog3", [](const M& m) { return numbers(Jlog3(m.angular)); }, [](const M& m) { return series(-cross(m.angular), 1).inverse().rounded(); },
       [](const M& m) { return Jlog3(m.angular).m[1]; }},
      {"Jexp6, off the diagonal", [](const M& m) { return numbers(Jexp6(m).upper); }, [jexp6](const M& m) { return upper(jexp6(m)); },
       [](const M& m) { return Jexp6(m).upper.m[1]; }},
      {"Jlog6, off the diagonal", [](const M& m) { return numbers(Jlog6(m).upper); }, [jexp6](const M& m) { return upper(jexp6(m).inverse()); },
       [](const M& m) { return Jlog6(m).upper.m[1]; }},
  };
}

/// ns per call, over motions of all angles.
double nanoseconds(const Function& f, const std::vector<Motion<double>>& motions) {
  volatile double kept = 0;
  const auto round = [&] {
    for (const Motion<double>& m : motions) kept = kept + f.call(m);
  };
  return measure(round, motions.size()).median;
}

}  // namespace

Section lieSection(const AccuracyOptions& options) {
  Section out;
  out.id = "lie";
  out.title = "Rotations and rigid motions: error against angle";
  out.text = {
      "Exponentials, logarithms and their derivatives, which all joints that turn about more than one axis are made of: the largest error of eight "
      "axes, relative to the largest entry, in units of roundoff. The reference takes series of matrices in a hundred digits. Where a library "
      "changes from a series to a closed form its error shows a peak; there is none here.",
      "What limits each: rounding alone. Times a call are means over all angles, a call through std::function and a number of the result included."};
  out.table.columns = {"function", "angle [rad]", "error max [u]", "ns a call"};
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto direction = [&] {
    const Vec3<double> x{normal(random), normal(random), normal(random)};
    return (1 / std::sqrt(dot(x, x))) * x;
  };
  std::vector<double> angles;
  const int points = options.quick ? 1 : 4;  // per decade
  for (int k = -12 * points; k <= 0; ++k) angles.push_back(std::pow(10.0, static_cast<double>(k) / points));
  for (const double angle : {1.5, 2.0, 2.5, 3.0, M_PI - 1e-3, M_PI - 1e-8}) angles.push_back(angle);
  std::vector<std::vector<Motion<double>>> motions;
  std::vector<Motion<double>> all;
  for (const double angle : angles) {
    auto& of_angle = motions.emplace_back();
    for (int k = 0; k < 8; ++k) of_angle.push_back({direction(), angle * direction()});
    all.insert(all.end(), of_angle.begin(), of_angle.end());
  }
  benchmark::LineChart chart("Error against angle", {"angle [rad]", benchmark::Scale::logarithmic},
                             {"largest error [u]", benchmark::Scale::logarithmic});
  const std::vector<Function> measured = functions();
  Progress progress(static_cast<double>(measured.size()), "functions");
  double done = 0;
  for (const Function& f : measured) {
    if (Interruption::pending()) break;
    progress.at(done++, f.name);
    const double ns = nanoseconds(f, all);
    for (std::size_t k = 0; k < angles.size(); ++k) {
      double worst = 0;
      for (const Motion<double>& m : motions[k]) worst = std::max(worst, relativeError(f.value(m), f.truth(m)));
      chart.add(f.name, angles[k], std::max(worst, 0.01));
      out.table.rows.push_back({f.name, angles[k], worst, ns});
    }
  }
  chart.guide("u", 1, 1, 0);
  out.charts.push_back(std::move(chart));
  return out;
}

}  // namespace dyn::tool
