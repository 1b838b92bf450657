// SPDX-License-Identifier: BSD-2-Clause
// Where all bars of a closed loop are in line, or nearly so, the loop's motion can continue along several branches. There a step may end on another
// branch than it began on, with a velocity and an energy that no force has caused. Such a step is repeated with shorter steps.
#include "integrate/simulator_impl.hpp"
#include "number_text.hpp"

#include <dyn/error.hpp>

#include <algorithm>

namespace dyn {

namespace {

/// Smallest change of velocity in a step that is checked, relative to the velocity.
constexpr double noticed_change = 0.02;
/// Smallest change of energy in a step that is checked, relative to the kinetic energy. Methods of low order have errors nearly as large.
constexpr double noticed_energy = 0.03;
/// A change over a step is unexplained if it exceeds this factor times what the rates at the step's ends give. Smooth motions reach 1.3.
constexpr double explained = 1.5;
/// The acceleration at a step's end is unexplained if, over one more step, it changes the velocity by more than this factor times both the velocity
/// and the change that the acceleration at the step's start gives.
constexpr double sudden = 2;

}  // namespace

bool Simulator::Impl::hasStrayed(double h) {
  if (!now_closed) return false;
  const double speed = std::max(equations.speed(now.q.data(), now.v.data()), equations.speed(next.q.data(), next.v.data()));
  change = next.v - now.v;
  const double changed = equations.speed(next.q.data(), change.data());
  if (!(changed > noticed_change * speed)) return false;
  const double before = h * equations.speed(now.q.data(), accelerationAt(equations, now)),
               after = h * equations.speed(next.q.data(), accelerationAt(equations, next));
  if (changed > explained * std::max(before, after) || after > sudden * std::max(before, speed)) return true;
  // Near a reversal the motion is slow, so the bound also counts the speed that the acceleration gives in one step.
  const double gained = std::abs(equations.energy(next.q.data(), next.v.data()) - equations.energy(now.q.data(), now.v.data()));
  const double unnoticed = noticed_energy * speed * speed + before * before;
  if (!(gained > unnoticed)) return false;
  const auto power = [&](const Moment& x) { return std::abs(equations.power(x.time, x.q.data(), x.v.data())); };
  return gained > unnoticed + explained * h * std::max(power(now), power(next));
}

double Simulator::Impl::followBranch(double h) {
  constexpr int most_halvings = 10;
  whole_step = false;
  double part = h;
  for (int i = 0; i < most_halvings; ++i) {
    part /= 2;
    ++equations.statistics.rejected;
    stepBy(part, now.time + part);
    project();
    if (!hasStrayed(part)) return part;
  }
  throw Error(ErrorCode::simulation, "from t = " + number(now.time) + " s on the loops have no smooth motion, even for a step of " + number(part) +
                                         " s: they are where motions of several kinds meet, or where bars are in line that cannot pass");
}

}  // namespace dyn
