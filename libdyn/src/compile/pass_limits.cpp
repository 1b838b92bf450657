// SPDX-License-Identifier: BSD-2-Clause
#include "at.hpp"
#include "compile/draft.hpp"

#include <dyn/joint/registry.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dyn {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Range {
  double lower = -infinity, upper = infinity;
  bool has(double x) const { return x >= lower && x <= upper; }
  bool limited() const { return std::isfinite(lower) || std::isfinite(upper); }
};

Range rangeOf(const DraftBody& body) {
  const JointLimits& limits = body.joint.limits;
  return {limits.lower.empty() ? -infinity : limits.lower[0], limits.upper.empty() ? infinity : limits.upper[0]};
}

/// A dependent joint's coordinate as a function of its master's.
class Relation {
 public:
  explicit Relation(const DraftCoupling& coupling) : coupling_(coupling) {}
  double operator()(double x) const { return derivatives(x)[0]; }
  double slope(double x) const { return derivatives(x)[1]; }
  /// Whether the function is affine, as far as a few places tell.
  bool isAffine() const {
    const double slope = derivatives(0)[1];
    return std::all_of(places.begin(), places.end(), [&](double x) {
      const std::array<double, 4> f = derivatives(x);
      return f[1] == slope && f[2] == 0 && f[3] == 0;
    });
  }

 private:
  static constexpr std::array<double, 6> places{0, 1, -1, 0.37, -2.9, 50};
  std::array<double, 4> derivatives(double x) const {
    std::array<double, 4> f{};
    coupling_.type->evaluate(coupling_.constants.data(), static_cast<int>(coupling_.constants.size()), x, f.data());
    return f;
  }
  const DraftCoupling& coupling_;
};

/// Goes from `x`, where f is within `wanted`, towards `end`. Returns how far f stays within `wanted`.
double reach(const Relation& f, const Range& wanted, double x, double end) {
  constexpr double step = 1e-3, far = 1e4;
  const double direction = end > x ? 1 : -1;
  while (x != end && std::abs(x) < far) {
    double next = x + direction * step * (1 + std::abs(x));
    if (direction * (next - end) > 0) next = end;
    if (!wanted.has(f(next))) {
      for (double middle = 0.5 * (x + next); middle != x && middle != next; middle = 0.5 * (x + next)) (wanted.has(f(middle)) ? x : next) = middle;
      return x;
    }
    x = next;
  }
  return end;
}

/// Narrows `own` to the range where f is within `wanted`. If there are several, it takes the one nearest to 0. Returns false if there is none.
bool narrow(const Relation& f, const Range& wanted, Range& own) {
  if (f.isAffine()) {
    const double slope = f.slope(0), start = f(0);
    if (slope == 0) return wanted.has(start);
    const double a = (wanted.lower - start) / slope, b = (wanted.upper - start) / slope;
    own = {std::max(own.lower, std::min(a, b)), std::min(own.upper, std::max(a, b))};
    return own.lower <= own.upper;
  }
  constexpr double step = 1e-3;
  constexpr int most_steps = 10000;
  for (int k = 0; k < most_steps; ++k)
    for (const double side : {1.0, -1.0}) {
      const double x = std::clamp(side * k * step, own.lower, own.upper);
      if (!wanted.has(f(x))) continue;
      own = {reach(f, wanted, x, own.lower), reach(f, wanted, x, own.upper)};
      return true;
    }
  return false;
}

void setFirst(std::vector<double>& values, double value) {
  if (values.empty() && !std::isfinite(value)) return;
  values.assign(1, value);
}

}  // namespace

void passLimitsOn(Draft& draft) {
  std::vector<std::size_t> dependents;
  for (std::size_t i = 1; i < draft.bodies.size(); ++i)
    if (draft.bodies[i].coupling) dependents.push_back(i);
  // The last joint of a chain comes first, because its master passes the limits on in turn.
  std::stable_sort(dependents.begin(), dependents.end(),
                   [&](std::size_t a, std::size_t b) { return draft.bodies[a].coupling->rank > draft.bodies[b].coupling->rank; });
  for (const std::size_t i : dependents) {
    const DraftBody& dependent = draft.bodies[i];
    DraftBody& master = draft.bodies[at(dependent.coupling->master)];
    const Range wanted = rangeOf(dependent);
    const auto warn = [&](const std::string& what) {
      draft.report.warnings.push_back("the limits of '" + dependent.joint.name + "', which follows '" + master.joint.name + "', " + what);
    };
    const Relation f(*dependent.coupling);
    if (dependent.instance.nq != 1 || master.instance.nq != 1) {
      if (wanted.limited()) warn("do not act: one of the two turns without end, and its position is no single number; load it as an angle");
      continue;
    }
    if (wanted.limited()) {
      Range own = rangeOf(master);
      if (narrow(f, wanted, own)) {
        setFirst(master.joint.limits.lower, own.lower);
        setFirst(master.joint.limits.upper, own.upper);
      } else {
        warn("exclude the other's own: they do not act");
      }
    }
    const std::vector<double>& velocity = dependent.joint.limits.velocity;
    if (velocity.empty() || !std::isfinite(velocity[0])) continue;
    if (!f.isAffine()) continue;  // a limit that depends on the position is not one number
    const double slope = std::abs(f.slope(0)), own = master.joint.limits.velocity.empty() ? infinity : master.joint.limits.velocity[0];
    if (slope > 0) setFirst(master.joint.limits.velocity, std::min(own, velocity[0] / slope));
  }
}

}  // namespace dyn
