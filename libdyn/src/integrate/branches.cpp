// Closed loops can go on in several ways from where all their bars are in line, or nearly so: there a step may end on another branch of the motion
// than it began on, with a velocity and an energy that nothing has given it. Such steps are taken again in parts.
#include "integrate/simulator_impl.hpp"
#include "number_text.hpp"

#include <dyn/error.hpp>

#include <algorithm>

namespace dyn {

namespace {

/// Of a velocity's change in a step, as a share of the velocity: what is less is not looked at.
constexpr double noticed_change = 0.02;
/// Of the energy's, as a share of the kinetic energy: methods of low order are off by nearly as much.
constexpr double noticed_energy = 0.03;
/// A change over a step by more than this much of what its ends' rates make is none that they explain; smooth motions have up to 1.3.
constexpr double explained = 1.5;
/// Nor do accelerations begin in a step that would change the velocity by this much of it in another.
constexpr double sudden = 2;

}  // namespace

bool Simulator::Impl::hasStrayed(double h) {
  if (!now_closed) return false;
  const double speed = std::max(law.speed(now.q.data(), now.v.data()), law.speed(next.q.data(), next.v.data()));
  change = next.v - now.v;
  const double changed = law.speed(next.q.data(), change.data());
  if (!(changed > noticed_change * speed)) return false;
  const double before = h * law.speed(now.q.data(), accelerationAt(law, now)), after = h * law.speed(next.q.data(), accelerationAt(law, next));
  if (changed > explained * std::max(before, after) || after > sudden * std::max(before, speed)) return true;
  // Where a motion turns, it is slow, and what a step is off counts by the speed that it makes.
  const double gained = std::abs(law.energy(next.q.data(), next.v.data()) - law.energy(now.q.data(), now.v.data()));
  const double unnoticed = noticed_energy * speed * speed + before * before;
  if (!(gained > unnoticed)) return false;
  const auto power = [&](const Moment& x) { return std::abs(law.power(x.time, x.q.data(), x.v.data())); };
  return gained > unnoticed + explained * h * std::max(power(now), power(next));
}

double Simulator::Impl::followBranch(double h) {
  constexpr int most_halvings = 10;
  whole_step = false;
  double part = h;
  for (int i = 0; i < most_halvings; ++i) {
    part /= 2;
    ++law.statistics.rejected;
    stepBy(part, now.time + part);
    project();
    if (!hasStrayed(part)) return part;
  }
  throw Error(ErrorCode::simulation, "from t = " + number(now.time) + " s on the loops have no smooth motion, even for a step of " + number(part) +
                                         " s: they are where motions of several kinds meet, or where bars are in line that cannot pass");
}

}  // namespace dyn
